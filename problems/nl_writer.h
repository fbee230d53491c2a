#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/types.h"

namespace taut {

/// A function of the variables x_0, x_1, ... as the expression tree of an .nl file: operators before their operands, a
/// line each, numbered as AMPL does [Gay 2005, "Writing .nl files", table 9].
class NlExpression {
 public:
  NlExpression(double constant = 0);
  static NlExpression variable(int index);
  const std::string& text() const { return text_; }
  bool is_zero() const { return text_ == "n0\n"; }

  friend NlExpression operator+(const NlExpression& a, const NlExpression& b);
  friend NlExpression operator-(const NlExpression& a, const NlExpression& b);
  friend NlExpression operator*(const NlExpression& a, const NlExpression& b);
  friend NlExpression operator-(const NlExpression& a);
  friend NlExpression square(const NlExpression& a);
  friend NlExpression sqrt(const NlExpression& a);
  friend NlExpression atan2(const NlExpression& y, const NlExpression& x);
  friend NlExpression sum(const std::vector<NlExpression>& terms);

 private:
  explicit NlExpression(std::string text) : text_(std::move(text)) {}
  std::string text_;
};
NlExpression sum(const std::vector<NlExpression>& terms);

/// A nonlinear expression plus coefficients of variables.
struct NlFunction {
  NlExpression nonlinear;
  std::map<int, double> linear;
};

/// minimise objective subject to lower <= row <= upper and bounds on the variables.
struct NlFile {
  struct Row {
    std::string name;
    NlFunction function;
    double lower, upper;
    double dual = 0;  ///< a first guess, with AMPL's sign: the rate of the objective in the bound
  };
  Vector start, lower, upper;               ///< of the variables
  std::vector<std::string> variable_names;  ///< as many
  NlFunction objective;
  std::vector<Row> rows;  ///< in any order; in the file the nonlinear ones come first

  /// Writes the model as text, and the names of variables and rows to .col and .row beside it. Throws FileError.
  void write(const std::filesystem::path& path) const;
};

}  // namespace taut
