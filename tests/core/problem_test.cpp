#include "core/problem.h"

#include <gmock/gmock.h>

#include "constraints/obstacle.h"
#include "energies/dead_load.h"
#include "support/specimens.h"

namespace taut {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

auto invalid(const std::string& text) { return ThrowsMessage<std::invalid_argument>(HasSubstr(text)); }

class ProblemOfTwoVertices : public testing::Test {
 protected:
  const DeadLoad load_{"gravity", Vector::Ones(6)};
  Problem problem_;
  void SetUp() override {
    problem_.initial_guess = Vector::Zero(6);
    problem_.energies = {&load_};
    problem_.fixed_variables = {0, 4};
    problem_.fixed_values = Vector::Zero(2);
  }
};

TEST_F(ProblemOfTwoVertices, IsValidAsItStands) { EXPECT_NO_THROW(problem_.validate()); }

TEST_F(ProblemOfTwoVertices, NamesTheEnergyWhoseVariablesDoNotExist) {
  problem_.initial_guess = Vector::Zero(3);
  EXPECT_THAT([&] { problem_.validate(); }, invalid("gravity: element 1 uses variable 3, expected 0 to 2"));
}

TEST_F(ProblemOfTwoVertices, NamesTheConstraintWhoseVariablesDoNotExist) {
  const HalfSpace floor("floor", "cloth", {0, 7}, 0, 1.0);
  problem_.constraints = {&floor};
  EXPECT_THAT([&] { problem_.validate(); }, invalid("floor: element 1 uses variable 21"));
}

TEST_F(ProblemOfTwoVertices, CountsFixedValues) {
  problem_.fixed_values = Vector::Zero(1);
  EXPECT_THAT([&] { problem_.validate(); }, invalid("2 fixed variables but 1 values"));
}

TEST_F(ProblemOfTwoVertices, WantsFixedVariablesToAscendWithinRange) {
  for (const std::vector<int>& wrong : {std::vector{4, 0}, {3, 3}, {-1, 2}, {2, 6}}) {
    problem_.fixed_variables = wrong;
    EXPECT_THAT([&] { problem_.validate(); }, invalid("fixed variables must ascend within 0 to 5"));
  }
}

TEST_F(ProblemOfTwoVertices, WantsNodesOfEqualSize) {
  for (int wrong : {0, 4}) {
    problem_.node_size = wrong;
    EXPECT_THAT([&] { problem_.validate(); }, invalid("node_size " + std::to_string(wrong)));
  }
}

TEST(Topology, NumbersNeverRepeatAndAreNotZero) {
  const auto first = new_topology(), second = new_topology();
  EXPECT_NE(first, 0u);
  EXPECT_NE(first, second);
}

TEST(Stencils, RejectElementsOfAnotherWidth) {
  Stencils stencils(6);
  EXPECT_THROW(stencils.add(std::vector{1, 2}), std::invalid_argument);
  EXPECT_THROW(stencils.add_vertices(std::vector{1}), std::invalid_argument);
  stencils.add_vertices(std::vector{1, 3});
  EXPECT_EQ(stencils.count(), 1);
  EXPECT_EQ(std::vector<int>(stencils[0], stencils[0] + 6), (std::vector<int>{3, 4, 5, 9, 10, 11}));
}

}  // namespace
}  // namespace taut
