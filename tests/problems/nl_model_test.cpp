#include "problems/nl_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "problems/nl_problem.h"
#include "problems/nl_writer.h"
#include "problems/scene.h"
#include "support/derivative_check.h"
#include "support/random_values.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const fs::path models = fs::path(TAUT_SOURCE_DIR) / "problems" / "nl";

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

class NlModelTest : public FilesTest {
 protected:
  fs::path write(const std::string& text) const {
    std::ofstream(path("model.nl"), std::ios::binary) << text;
    return path("model.nl");
  }
  std::string refusal(const std::string& text) const {
    try {
      const NlModel model(write(text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "read";
  }
};

TEST_F(NlModelTest, ReadsBoundsRowsAndStart) {
  const NlModel model(models / "range_rows.nl");
  EXPECT_EQ(model.name(), "range_rows");
  EXPECT_TRUE(model.maximise());
  EXPECT_EQ(model.variables(), 2);
  EXPECT_EQ(model.lower(), Vector::Constant(2, -1));
  EXPECT_EQ(model.upper(), Vector::Constant(2, 5));
  EXPECT_EQ(model.row_lower(), (Vector(2) << 1, 0).finished());
  EXPECT_EQ(model.row_upper(), (Vector(2) << 2, 4).finished());
  EXPECT_EQ(model.start(), Vector::Zero(2));
  EXPECT_TRUE(model.linear(NlModel::objective));
  EXPECT_EQ(model.variables_of(0), (std::vector<int>{0, 1}));
}

TEST_F(NlModelTest, NamesComeFromTheFilesBeside) {
  const fs::path path = write(text_of(models / "range_rows.nl"));
  std::ofstream(fs::path(path).replace_extension(".col")) << "width\nheight\n";
  std::ofstream(fs::path(path).replace_extension(".row")) << "difference\nsum\n";
  const NlModel model(path);
  EXPECT_EQ(model.variable_name(1), "height");
  EXPECT_EQ(model.row_name(0), "difference");
}

TEST_F(NlModelTest, ValuesAreThoseOfTheFormula) {
  const NlModel model(models / "infeasible_start.nl");
  const double x[] = {3, -2};
  double gradient[2], hessian[4];
  EXPECT_EQ(model.evaluate(NlModel::objective, x, gradient, hessian), 13);
  EXPECT_THAT(gradient, testing::ElementsAre(6, -4));
  EXPECT_THAT(hessian, testing::ElementsAre(2, 0, 0, 2));
  EXPECT_EQ(model.evaluate(0, x, gradient, hessian), -6);
  EXPECT_THAT(gradient, testing::ElementsAre(-2, 3));
  EXPECT_THAT(hessian, testing::ElementsAre(0, 1, 1, 0));
}

TEST_F(NlModelTest, EveryFunctionOfEveryModelHasTheRightDerivatives) {
  int functions = 0;
  for (const auto& entry : fs::directory_iterator(models)) {
    if (entry.path().extension() != ".nl") continue;
    const NlModel model(entry.path());
    const NlProblem posed(model);
    const Problem& problem = posed.problem();
    const Vector x = problem.initial_guess + 0.3 * RandomValues(7).vector(problem.size());
    for (const Energy* energy : problem.energies) {
      expect_derivatives(*energy, x, SemidefiniteForm::projection, model.name() + ", objective");
      ++functions;
    }
    for (const Constraint* constraint : problem.constraints) {
      for (const double multiplier : {1.5, -0.7}) {
        expect_derivatives(Contraction(*constraint, Vector::Constant(1, multiplier)), x, SemidefiniteForm::projection,
                           model.name() + ", " + constraint->name());
      }
      ++functions;
    }
  }
  EXPECT_GT(functions, 25);
}

TEST_F(NlModelTest, OutsideAFunctionsDomainIsNotANumber) {
  // min log(x0), as made by make.py.
  const NlModel model(
      write("g3 1 1 0\n 1 0 1 0 0 0\n 0 1\n 0 0\n 0 1 0\n 0 0 0 1\n 0 0 0 0 0\n 0 1\n 0 0\n"
            " 0 0 0 0 0\nO0 0\no43\nv0\nx1\n0 1\nb\n3\nG0 1\n0 0\n"));
  const double inside = 2, outside = -1;
  double gradient = 0;
  EXPECT_DOUBLE_EQ(model.evaluate(NlModel::objective, &inside, &gradient, nullptr), std::log(2));
  EXPECT_DOUBLE_EQ(gradient, 0.5);
  EXPECT_TRUE(std::isnan(model.evaluate(NlModel::objective, &outside, &gradient, nullptr)));
  EXPECT_TRUE(std::isnan(gradient));
  EXPECT_DOUBLE_EQ(model.evaluate(NlModel::objective, &inside, nullptr, nullptr), std::log(2)) << "and recovers";
}

TEST_F(NlModelTest, RefusesWhatItCannotServeInOneLine) {
  const std::string good = text_of(models / "range_rows.nl");
  const auto with_line = [&good](int wanted, const std::string& replacement) {
    std::istringstream lines(good);
    std::string text;
    int number = 0;
    for (std::string line; std::getline(lines, line);) text += (++number == wanted ? replacement : line) + "\n";
    return text;
  };
  EXPECT_EQ(refusal(good), "read");
  EXPECT_THAT(refusal(with_line(7, " 0 1 0 0 0")), HasSubstr("1 integer variables"));
  EXPECT_THAT(refusal("{\"format\": 1}"), HasSubstr("is no .nl file"));
  for (const std::size_t length : {3u, 40u, 120u, 150u, 200u}) {
    const std::string reason = refusal(good.substr(0, length));
    EXPECT_THAT(reason, HasSubstr("cannot be read")) << length;
    EXPECT_EQ(reason.find('\n'), std::string::npos);
  }
  EXPECT_THROW(NlModel(models / "not_there.nl"), InputError);
}

/// Appends numbers as a binary .nl file holds them: four bytes for an integer, eight for a double.
template <class... Values>
void append(std::string& bytes, Values... values) {
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
}

TEST_F(NlModelTest, BinaryFilesAreRead) {
  // min (x0 - 3)^2 with x0 <= 2, the header as in text but for "b" and the kind of arithmetic (1: little-endian).
  std::string bytes = "b3 1 1 0\n 1 0 1 0 0 0\n 0 1\n 0 0\n 0 1 0\n 0 0 1 1\n 0 0 0 0 0\n 0 1\n 0 0\n 0 0 0 0 0\n";
  append(bytes, 'O', 0, 0);  // objective 0 is minimised
  append(bytes, 'o', 5);     // a power
  append(bytes, 'o', 1, 'v', 0, 'n', 3.0, 'n', 2.0);
  append(bytes, 'x', 1, 0, 1.0);  // start
  append(bytes, 'b', '1', 2.0);   // an upper bound
  append(bytes, 'G', 0, 1, 0, 0.0);
  const NlModel model(write(bytes));
  EXPECT_EQ(model.start(), Vector::Ones(1));
  EXPECT_EQ(model.upper(), Vector::Constant(1, 2));
  const double x = 5;
  double gradient, hessian;
  EXPECT_EQ(model.evaluate(NlModel::objective, &x, &gradient, &hessian), 4);
  EXPECT_EQ(gradient, 4);
  EXPECT_EQ(hessian, 2);
}

TEST_F(NlModelTest, ARowWithoutVariablesOutsideItsBoundsIsRefusedByName) {
  // min x0 with 1 <= 5 <= 2.
  const std::string text =
      "g3 1 1 0\n 1 1 1 1 0 0\n 0 0\n 0 0\n 0 0 0\n 0 0 0 1\n 0 0 0 0 0\n 0 1\n 0 0\n"
      " 0 0 0 0 0\nC0\nn5\nO0 0\nn0\nr\n0 1 2\nb\n3\nk0\nG0 1\n0 1\n";
  const NlModel model(write(text));
  EXPECT_TRUE(model.variables_of(0).empty());
  try {
    const NlProblem posed(model);
    FAIL() << "posed";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("without variables and outside its bounds"));
  }
}

/// min (1 - x_0)^2 (1 - x_1)^2 ... of all variables with sum x_i <= count: functions of more variables than a stencil
/// of a scene has, and no sums of small terms.
NlFile wide_model(int count) {
  NlFile file;
  file.start = Vector::Constant(count, 0.5);
  file.lower = Vector::Constant(count, -10);
  file.upper = Vector::Constant(count, 10);
  NlExpression product = 1;
  NlFile::Row sum_row{"sum", {}, -HUGE_VAL, static_cast<double>(count)};
  for (int i = 0; i < count; ++i) {
    product = product * square(1 - NlExpression::variable(i));
    sum_row.function.linear[i] = 1;
    file.variable_names.push_back("x" + std::to_string(i));
  }
  file.objective.nonlinear = product;
  file.rows.push_back(sum_row);
  return file;
}

TEST_F(NlModelTest, WideFunctionsHaveTheRightDerivatives) {
  wide_model(80).write(path("wide.nl"));
  const NlModel model(path("wide.nl"));
  ASSERT_EQ(model.variables_of(NlModel::objective).size(), 80u);
  const NlProblem posed(model);
  const Vector x = 0.1 * RandomValues(3).vector(80);
  expect_derivatives(*posed.problem().energies[0], x, SemidefiniteForm::projection, "wide objective");
  const Constraint& row = *posed.problem().constraints.back();
  ASSERT_EQ(row.stencils().width(), 80);
  expect_derivatives(Contraction(row, Vector::Constant(1, 1.5)), x, SemidefiniteForm::projection, "wide row");
}

TEST_F(NlModelTest, BoundsThatCrossAreRefusedByName) {
  std::string text = text_of(models / "range_rows.nl");
  const std::string row = "\n0 1 2\n";
  ASSERT_NE(text.find(row), text.npos);
  text.replace(text.find(row), row.size(), "\n0 2 1\n");
  const NlModel model(write(text));
  try {
    const NlProblem posed(model);
    FAIL() << "posed";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("lower bound above the upper one in row"));
  }
}

TEST_F(NlModelTest, OutsideItsDomainARowIsNotSatisfied) {
  // min x0 with log(x0) >= 0.
  const NlModel model(
      write("g3 1 1 0\n 1 1 1 0 0 0\n 1 0\n 0 0\n 1 0 0\n 0 0 0 1\n 0 0 0 0 0\n 1 1\n 0 0\n"
            " 0 0 0 0 0\nC0\no43\nv0\nO0 0\nn0\nx1\n0 1\nr\n2 0\nb\n3\nk0\nJ0 1\n0 0\nG0 1\n0 1\n"));
  const NlProblem posed(model);
  const double outside = -1, inside = 0.5;
  const Constraint& row = *posed.problem().constraints[0];
  EXPECT_TRUE(std::isnan(row.violation(0, &outside)));
  EXPECT_DOUBLE_EQ(row.violation(0, &inside), std::log(2));
}

}  // namespace
}  // namespace taut
