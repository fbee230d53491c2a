#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/result.h"

namespace taut {

/// An optimisation model as AMPL, Pyomo and JuMP write it (.nl, text or binary): minimise or maximise f(x) subject to
/// lower <= g(x) <= upper and bounds on x. Values and exact derivatives by AMPL's solver library [Gay 1997, "Hooking
/// your solver to AMPL"]. Each function is seen through the variables that it depends on, in the order of variables_of.
/// Not for several threads at once.
class NlModel {
 public:
  /// Stands for the objective where a function is asked for; rows are 0, 1, ...
  static constexpr int objective = -1;

  /// `file` with or without its ending .nl. Throws InputError for a file that cannot be read and for models with
  /// integer variables, logical or complementarity conditions, or functions of somebody else's library.
  explicit NlModel(const std::filesystem::path& file);
  ~NlModel();
  NlModel(const NlModel&) = delete;
  NlModel& operator=(const NlModel&) = delete;

  const std::string& name() const;  ///< of the file, without ending
  std::filesystem::path file() const;
  int variables() const;
  int rows() const;
  bool has_objective() const;
  bool maximise() const;
  const Vector& lower() const;  ///< of the variables, -infinity where there is no bound
  const Vector& upper() const;
  const Vector& row_lower() const;  ///< of the rows
  const Vector& row_upper() const;
  const Vector& start() const;       ///< zero where the model has none
  const Vector& start_dual() const;  ///< first guess at NlProblem::dual, zero where the model has none
  std::string variable_name(int variable) const;
  std::string row_name(int row) const;

  const std::vector<int>& variables_of(int function) const;
  bool linear(int function) const;
  /// The value of a function of its own variables; NaN outside its domain. `gradient` (as many entries) and `hessian`
  /// (dense, both triangles) are overwritten where they are not null.
  double evaluate(int function, const double* x, double* gradient, double* hessian) const;

  /// Its value where all variables of the model are given.
  double value_at(int function, const Vector& x) const;

  /// Writes the model's .sol file beside it: `dual` has the sign of AMPL, the rate of the objective in the row's bound.
  /// `code` is solve_result_num. Throws FileError.
  void write_solution(const std::string& message, int code, const Vector& x, const Vector& dual) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace taut
