#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/types.h"

namespace taut {

/// How a solve ended. `solved` is said by the residuals (core/residuals.h), never by a solver alone.
enum class Status {
  solved,           ///< the independent residuals are within tolerance
  infeasible,       ///< a stationary point of the violation; x is the closest compromise found
  unbounded,        ///< the objective falls without limit
  stalled,          ///< no further progress at this precision
  limit_point,      ///< a static path turned back
  iteration_limit,  ///< the allowed iterations are used up
  time_limit,       ///< the allowed seconds are used up
  not_finite,       ///< a NaN or an infinity that no shorter step avoids
  interrupted,      ///< a person or the system asked to stop
};
std::string_view to_string(Status status);
/// The status of that name; throws std::invalid_argument for any other text.
Status status_from_string(std::string_view text);

/// How often a solver did what.
struct Counts {
  long outer = 0;                   ///< multiplier updates
  long linear_solves = 0;           ///< Newton systems solved
  long factorizations = 0;          ///< numeric factorisations, failed ones included
  long pivoted_factorizations = 0;  ///< those of them that needed pivoting, and are slower for it
  long inner_iterations = 0;        ///< of conjugate gradients on Newton systems
  long symbolic_analyses = 0;       ///< orderings and symbolic factorisations
  long matrix_allocations = 0;      ///< sparse matrices or slot tables allocated
  long function_evaluations = 0;    ///< values of the objective, with or without derivatives
  long screened = 0;                ///< elements of constraints left out of a solve, too far from their boundary
  long screening_failures = 0;      ///< solves that began again with them, as one was violated
  double factor_flops = 0;          ///< floating-point operations of the factorisations; 0 where not known
  Counts& operator+=(const Counts& other);
};

/// Wall-clock seconds by phase.
struct Timings {
  double total = 0, assembly = 0, analysis = 0, factorization = 0, solve = 0;
  Timings& operator+=(const Timings& other);
};

/// What a solver returns. `multipliers` has one vector per constraint (element by element, `rows()` entries each), then
/// one per system of equalities.
struct Result {
  Status status = Status::iteration_limit;
  Vector x;
  std::vector<Vector> multipliers;
  std::vector<double> penalties;  ///< at the start of the solve, one per constraint (a warm start for the next); empty
                                  ///< for solvers that have none
  std::vector<double> changes;  ///< largest |c(x) - c(initial guess)| of any element, one per constraint (a warm start
                                ///< for the next); empty for solvers that screen nothing
  double force_scale = 0;  ///< N, Residuals::force_scale where the solver has judged itself (a warm start for the next)
  Counts counts;
  Timings timings;
  std::string message;  ///< one sentence on why it ended so
  /// The library behind the solver claims success, which the residuals do not call solved.
  bool overruled = false;
};

}  // namespace taut
