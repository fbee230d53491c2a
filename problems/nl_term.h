#pragma once

#include <filesystem>
#include <vector>

namespace taut {

/// Operators of .nl expressions with their numbers there [Gay 2005, "Writing .nl files", table 9]; those that are not
/// smooth are missing. constant and variable stand for leaves.
enum class NlOperator {
  plus = 0,
  minus = 1,
  times = 2,
  divide = 3,
  power = 5,
  negate = 16,
  tanh = 37,
  tan = 38,
  sqrt = 39,
  sinh = 40,
  sin = 41,
  log10 = 42,
  log = 43,
  exp = 44,
  cosh = 45,
  cos = 46,
  atanh = 47,
  atan2 = 48,
  atan = 49,
  asinh = 50,
  asin = 51,
  acosh = 52,
  acos = 53,
  constant,
  variable,
};

/// One term of a sum that has few variables, with exact derivatives by forward differentiation. AMPL's library has
/// derivatives of whole functions only: of n terms, each would cost as much as all.
struct NlTerm {
  struct Node {
    NlOperator what;
    int left = -1, right = -1;  ///< operands, earlier nodes; of a variable `left` is its place in `variables`
    double value = 0;           ///< of a constant
  };
  std::vector<int> variables;
  std::vector<Node> nodes;  ///< operands before operators, the last one is the term's value

  /// The value at x (as many doubles as variables); NaN or infinite outside the domain. `gradient` and `hessian`
  /// (dense, both triangles) are overwritten where they are not null.
  double evaluate(const double* x, double* gradient, double* hessian) const;
};

/// The objective of a model as a sum of terms of at most `most` variables each, its linear part among them and its
/// constant left out; empty where it is no such sum, or has an operator that NlOperator has not. `file` is one that
/// NlModel has read.
std::vector<NlTerm> objective_terms(const std::filesystem::path& file, int most);

}  // namespace taut
