#include "problems/nl_term.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "problems/nl_model.h"
#include "problems/nl_problem.h"
#include "problems/nl_writer.h"
#include "support/random_values.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

constexpr int count = 80;

class NlTermTest : public FilesTest {
 protected:
  /// min of the sum of `terms`, expressions in the lines of an .nl file, plus x0 + 2 x1 + 3 x2 + ...; with one defined
  /// variable, v80 = 2 x0 + x1 x2.
  std::filesystem::path write(const std::vector<std::string>& terms) const {
    const std::string n = std::to_string(count);
    std::ofstream file(path("model.nl"), std::ios::binary);
    file << "g3 1 1 0\n " << n << " 0 1 0 0 0\n 0 1\n 0 0\n 0 " << n << " 0\n 0 0 0 1\n 0 0 0 0 0\n 0 " << n
         << "\n 0 0\n 0 0 1 0 0\nV" << n << " 1 0\n0 2\no2\nv1\nv2\nO0 0\no54\n"
         << terms.size() << "\n";
    for (const std::string& term : terms) file << term;
    file << "b\n";
    for (int i = 0; i < count; ++i) file << "3\n";
    file << "k" << count - 1 << "\n";
    for (int i = 1; i < count; ++i) file << "0\n";
    file << "G0 " << n << "\n";
    for (int i = 0; i < count; ++i) file << i << " " << i + 1 << "\n";
    return path("model.nl");
  }
};

TEST_F(NlTermTest, TermsAddUpToTheFunctionThatAmplsLibraryEvaluates) {
  std::vector<std::string> terms{"o5\nv0\nn3\n",          "o5\nv1\nn-1.5\n",
                                 "o5\nn2\nv2\n",          "o5\nv3\nv4\n",
                                 "o5\nv5\nn2\n",          "o3\nv6\no0\nv7\nn1\n",
                                 "o48\nv8\nv9\n",         "o48\nv8\no16\nv9\n",
                                 "o2\nv80\nv3\n",         "o44\nv80\n",
                                 "o2\nn-3\no1\nv1\nv2\n", "o16\no2\nv4\no2\nv5\nv6\n",
                                 "o52\no0\nv10\nn1.5\n",  "o2\no54\n3\nv11\nv12\no5\nv13\nn2\no41\nv11\n"};
  for (const int unary : {37, 38, 39, 40, 41, 42, 43, 44, 45, 46, 47, 49, 50, 51, 53})
    terms.push_back("o" + std::to_string(unary) + "\no2\nv14\nv" + std::to_string(unary) + "\n");
  const NlModel model(write(terms));
  const std::vector<NlTerm> split = objective_terms(model.file(), 8);
  ASSERT_EQ(split.size(), terms.size() + 1 + count) << "of the product of -3 and a difference two, and the linear part";

  Vector x = (0.5 * Vector::Ones(count) + 0.3 * RandomValues(5).vector(count)).cwiseMax(0.2).cwiseMin(0.8);
  Vector gradient = Vector::Zero(count), expected_gradient(count);
  Matrix hessian = Matrix::Zero(count, count), expected_hessian(count, count);
  double value = 0;
  for (const NlTerm& term : split) {
    const auto width = static_cast<Index>(term.variables.size());
    Vector local = x(term.variables), part(width);
    Matrix curvature(width, width);
    value += term.evaluate(local.data(), part.data(), curvature.data());
    gradient(term.variables) += part;
    hessian(term.variables, term.variables) += curvature;
  }
  const std::vector<int>& own = model.variables_of(NlModel::objective);
  ASSERT_EQ(own.size(), static_cast<std::size_t>(count));
  const double expected =
      model.evaluate(NlModel::objective, Vector(x(own)).data(), expected_gradient.data(), expected_hessian.data());
  EXPECT_NEAR(value, expected, 1e-12 * std::abs(expected));
  EXPECT_LE((Vector(gradient(own)) - expected_gradient).lpNorm<Eigen::Infinity>(),
            1e-12 * expected_gradient.lpNorm<Eigen::Infinity>());
  EXPECT_LE((Matrix(hessian(own, own)) - expected_hessian).lpNorm<Eigen::Infinity>(),
            1e-12 * expected_hessian.lpNorm<Eigen::Infinity>());
}

TEST_F(NlTermTest, WhatIsNoSumOfSmallSmoothTermsIsLeftWhole) {
  std::string wide = "o5\no54\n" + std::to_string(count) + "\n";
  for (int i = 0; i < count; ++i) wide += "v" + std::to_string(i) + "\n";
  EXPECT_THAT(objective_terms(write({wide + "n2\n", "v1\n", "v2\n"}), 64), testing::IsEmpty())
      << "square of a wide sum";
  EXPECT_THAT(objective_terms(write({"o13\nv1\n", "v2\n", "v3\n"}), 64), testing::IsEmpty()) << "floor";
  const NlModel model(write({wide + "n2\n", "v1\n", "v2\n"}));
  const NlProblem posed(model);
  ASSERT_EQ(posed.problem().energies.size(), 1u);
  EXPECT_EQ(posed.problem().energies[0]->stencils().width(), count);
}

TEST_F(NlTermTest, MaximisedTermsAreNegated) {
  NlFile file;
  file.start = file.lower = file.upper = Vector::Zero(count);
  file.lower.setConstant(-1);
  file.upper.setConstant(2);
  std::vector<NlExpression> squares;
  for (int i = 0; i < count; ++i) {
    squares.push_back(square(NlExpression::variable(i) - 1));
    file.variable_names.push_back("x" + std::to_string(i));
  }
  file.objective.nonlinear = sum(squares);
  file.write(path("model.nl"));
  std::ostringstream written;
  written << std::ifstream(path("model.nl")).rdbuf();
  std::string text = written.str();
  ASSERT_NE(text.find("\nO0 0\n"), text.npos);
  text.replace(text.find("\nO0 0\n"), 6, "\nO0 1\n");
  std::ofstream(path("model.nl"), std::ios::binary) << text;
  const NlModel model(path("model.nl"));
  ASSERT_TRUE(model.maximise());
  const NlProblem posed(model);
  ASSERT_EQ(posed.problem().energies.size(), 1u);
  const double x = 0.5;
  double gradient, hessian;
  EXPECT_EQ(posed.problem().energies[0]->evaluate(3, &x, &gradient, &hessian, Curvature::exact), -0.25);
  EXPECT_EQ(gradient, 1);
  EXPECT_EQ(hessian, -2);
  ASSERT_EQ(posed.problem().constraints.size(), 1u) << "equal bounds are one family";
  EXPECT_EQ(posed.problem().constraints[0]->stencils().count(), count);
}

}  // namespace
}  // namespace taut
