#include "solvers/nlopt.h"

#include <nlopt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "core/stopwatch.h"
#include "solvers/nonlinear_program.h"
#include "solvers/nonnegative_least_squares.h"

namespace taut {
namespace {

struct Entry {
  NloptAlgorithm algorithm;
  std::string_view name;
  nlopt_algorithm outer, inner;  // equal where there is no inner one
  int largest;
};
constexpr std::array<Entry, 5> algorithms{{
    {NloptAlgorithm::slsqp, "slsqp", NLOPT_LD_SLSQP, NLOPT_LD_SLSQP, 600},
    {NloptAlgorithm::auglag_slsqp, "auglag_slsqp", NLOPT_AUGLAG, NLOPT_LD_SLSQP, 600},
    {NloptAlgorithm::auglag_lbfgs, "auglag_lbfgs", NLOPT_AUGLAG, NLOPT_LD_LBFGS, 600},
    {NloptAlgorithm::auglag_ccsaq, "auglag_ccsaq", NLOPT_AUGLAG, NLOPT_LD_CCSAQ, 600},
    {NloptAlgorithm::auglag_tnewton, "auglag_tnewton", NLOPT_AUGLAG, NLOPT_LD_TNEWTON_PRECOND_RESTART, 600},
}};

const Entry& entry(NloptAlgorithm algorithm) {
  for (const Entry& each : algorithms)
    if (each.algorithm == algorithm) return each;
  throw std::invalid_argument("not an NloptAlgorithm");
}

/// One bound of one row as NLopt wants it: sign (g_row - bound) <= 0, or = 0.
struct OneSided {
  Index row;
  double sign, bound;
};

struct Scaling {
  Vector y0, d;
  double f0 = 0, s = 1;
  Vector row;  // factor on each row
};

Scaling scaling_of(NonlinearProgram& program, const Vector& y) {
  Scaling scaling;
  scaling.y0 = y;
  const Index n = program.variables();
  Vector gradient, values;
  scaling.f0 = program.gradient(scaling.y0, gradient);
  program.hessian(scaling.y0, 1, Vector::Zero(program.rows()), values);
  Vector diagonal = Vector::Zero(n);
  const TripletPattern& h = program.hessian_pattern();
  for (std::size_t k = 0; k < h.rows.size(); ++k)
    if (h.rows[k] == h.columns[k]) diagonal[h.rows[k]] += values[static_cast<Index>(k)];
  const double floor = std::max(1e-8 * diagonal.cwiseAbs().maxCoeff(), 1e-300);
  diagonal = diagonal.cwiseAbs().cwiseMax(floor);
  scaling.s = (gradient.array().square() / diagonal.array()).maxCoeff();
  if (!(scaling.s > 0) || !std::isfinite(scaling.s)) scaling.s = 1;
  scaling.d = (scaling.s / diagonal.array()).sqrt();

  program.jacobian(scaling.y0, values);
  const TripletPattern& j = program.jacobian_pattern();
  Vector squares = Vector::Zero(program.rows());
  for (std::size_t k = 0; k < j.rows.size(); ++k) {
    const double entry = values[static_cast<Index>(k)] * scaling.d[j.columns[k]];
    squares[j.rows[k]] += entry * entry;
  }
  // A gradient that happens to vanish at the start is not worth a division.
  const double smallest = squares.size() ? std::max(1e-4 * squares.maxCoeff(), 1e-300) : 1.0;
  scaling.row = squares.cwiseMax(smallest).cwiseSqrt().cwiseInverse();
  return scaling;
}

/// What NLopt calls back, in C: exceptions are kept and NLopt is told to stop.
struct Callbacks {
  NonlinearProgram& program;
  const Scaling& scaling;
  const Budget& budget;
  Result& result;
  std::vector<OneSided> inequalities = {}, equalities = {};
  nlopt_opt optimiser = nullptr;
  std::exception_ptr failure = nullptr;
  Vector values = {}, g = {};

  Vector unscaled(const double* z) const {
    return scaling.y0 + scaling.d.cwiseProduct(Eigen::Map<const Vector>(z, scaling.d.size()));
  }

  double objective(const double* z, double* gradient) {
    // Large, finite and flat: NLopt takes a NaN for an improvement, and infinities make NaNs of its own.
    constexpr double rejected = 1e30;
    ++result.counts.function_evaluations;
    if (budget.interrupted() || budget.out_of_time()) nlopt_force_stop(optimiser);
    const Vector y = unscaled(z);
    const double value = ((gradient ? program.gradient(y, values) : program.objective(y)) - scaling.f0) / scaling.s;
    const bool finite = std::isfinite(value) && (!gradient || values.allFinite());
    if (gradient) {
      Eigen::Map<Vector> target(gradient, scaling.d.size());
      if (finite)
        target = scaling.d.cwiseProduct(values) / scaling.s;
      else
        target.setZero();
    }
    return finite ? value : rejected;
  }

  void rows(const std::vector<OneSided>& which, double* out, const double* z, double* gradient) {
    const Vector y = unscaled(z);
    program.constraints(y, g);
    for (std::size_t i = 0; i < which.size(); ++i)
      out[i] = scaling.row[which[i].row] * which[i].sign * (g[which[i].row] - which[i].bound);
    if (!gradient) return;
    const Index n = scaling.d.size();
    std::vector<std::vector<Index>> targets(static_cast<std::size_t>(program.rows()));
    for (std::size_t i = 0; i < which.size(); ++i) targets[which[i].row].push_back(static_cast<Index>(i));
    std::fill_n(gradient, n * static_cast<Index>(which.size()), 0.0);
    program.jacobian(y, values);
    const TripletPattern& j = program.jacobian_pattern();
    for (std::size_t k = 0; k < j.rows.size(); ++k) {
      for (Index i : targets[j.rows[k]]) {
        const Index column = j.columns[k];
        gradient[i * n + column] +=
            scaling.row[j.rows[k]] * which[i].sign * scaling.d[column] * values[static_cast<Index>(k)];
      }
    }
  }

  template <class Work>
  void guarded(const Work& work) {
    const Stopwatch watch(result.timings.assembly);
    try {
      if (!failure) work();
    } catch (...) {
      failure = std::current_exception();
      nlopt_force_stop(optimiser);
    }
  }
};

double call_objective(unsigned, const double* z, double* gradient, void* data) {
  auto& callbacks = *static_cast<Callbacks*>(data);
  double value = std::numeric_limits<double>::infinity();
  callbacks.guarded([&] { value = callbacks.objective(z, gradient); });
  return value;
}

void call_inequalities(unsigned, double* out, unsigned, const double* z, double* gradient, void* data) {
  auto& callbacks = *static_cast<Callbacks*>(data);
  callbacks.guarded([&] { callbacks.rows(callbacks.inequalities, out, z, gradient); });
}

void call_equalities(unsigned, double* out, unsigned, const double* z, double* gradient, void* data) {
  auto& callbacks = *static_cast<Callbacks*>(data);
  callbacks.guarded([&] { callbacks.rows(callbacks.equalities, out, z, gradient); });
}

void split_bounds(const NonlinearProgram& program, Callbacks& callbacks) {
  for (Index row = 0; row < program.rows(); ++row) {
    const double lower = program.lower()[row], upper = program.upper()[row];
    if (lower == upper) {
      callbacks.equalities.push_back({row, 1, upper});
      continue;
    }
    if (std::isfinite(upper)) callbacks.inequalities.push_back({row, 1, upper});
    if (std::isfinite(lower)) callbacks.inequalities.push_back({row, -1, lower});
  }
}

using Optimiser = std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)>;

Optimiser make(nlopt_algorithm algorithm, Index n) {
  Optimiser optimiser(nlopt_create(algorithm, static_cast<unsigned>(n)), nlopt_destroy);
  if (!optimiser) throw std::bad_alloc();
  return optimiser;
}

void check(nlopt_result code, nlopt_opt optimiser) {
  if (code == NLOPT_OUT_OF_MEMORY) throw std::bad_alloc();
  if (code != NLOPT_INVALID_ARGS) return;
  const char* text = nlopt_get_errmsg(optimiser);
  throw std::logic_error(std::string("NLopt refuses its arguments: ") + (text ? text : ""));
}

/// Runs NLopt from z = 0 and leaves the best point there; NLOPT_INVALID_ARGS where it would refuse to.
nlopt_result optimise(const NloptOptions& options, Callbacks& callbacks, Vector& z) {
  if (static_cast<Index>(callbacks.equalities.size()) > z.size()) return NLOPT_INVALID_ARGS;
  const Entry& chosen = entry(options.algorithm);
  const Optimiser optimiser = make(chosen.outer, z.size());
  callbacks.optimiser = optimiser.get();
  const double accuracy = 1e-4 * std::min({options.tolerances.stationarity, options.tolerances.feasibility, 1e-6});
  check(nlopt_set_min_objective(optimiser.get(), call_objective, &callbacks), optimiser.get());
  const auto add = [&](const std::vector<OneSided>& rows, auto add_rows, nlopt_mfunc call) {
    if (rows.empty()) return;
    const std::vector<double> tolerances(rows.size(), accuracy);
    check(add_rows(optimiser.get(), static_cast<unsigned>(rows.size()), call, &callbacks, tolerances.data()),
          optimiser.get());
  };
  add(callbacks.inequalities, nlopt_add_inequality_mconstraint, call_inequalities);
  add(callbacks.equalities, nlopt_add_equality_mconstraint, call_equalities);
  nlopt_set_maxeval(optimiser.get(), std::max(1, options.max_evaluations -
                                                     static_cast<int>(callbacks.result.counts.function_evaluations)));
  nlopt_set_xtol_abs1(optimiser.get(), accuracy);
  if (chosen.outer != chosen.inner) {
    const Optimiser inner = make(chosen.inner, z.size());
    nlopt_set_xtol_abs1(inner.get(), accuracy);
    nlopt_set_ftol_abs(inner.get(), 1e-15);
    check(nlopt_set_local_optimizer(optimiser.get(), inner.get()), optimiser.get());  // a copy
  }
  double value = 0;
  const nlopt_result code = nlopt_optimize(optimiser.get(), z.data(), &value);
  if (callbacks.failure) std::rethrow_exception(callbacks.failure);
  check(code, optimiser.get());
  return code;
}

/// Row multipliers nu with f' + J^T nu nearly zero, on the rows within `distance` of a bound.
Vector recovered(NonlinearProgram& program, const Callbacks& callbacks, const Vector& y, double distance) {
  Vector gradient, values, g;
  program.gradient(y, gradient);
  program.constraints(y, g);
  program.jacobian(y, values);
  std::vector<OneSided> active = callbacks.equalities;
  for (const OneSided& one : callbacks.inequalities)
    if (one.sign * (g[one.row] - one.bound) >= -distance) active.push_back(one);

  const Vector& d = callbacks.scaling.d;  // forces in NLopt's variables, where they compare
  Matrix columns = Matrix::Zero(program.variables(), static_cast<Index>(active.size()));
  std::vector<std::vector<Index>> targets(static_cast<std::size_t>(program.rows()));
  std::vector<char> free(active.size(), 0);
  for (std::size_t i = 0; i < active.size(); ++i) {
    targets[active[i].row].push_back(static_cast<Index>(i));
    free[i] = i < callbacks.equalities.size();
  }
  const TripletPattern& j = program.jacobian_pattern();
  for (std::size_t k = 0; k < j.rows.size(); ++k)
    for (Index i : targets[j.rows[k]])
      columns(j.columns[k], i) += active[i].sign * d[j.columns[k]] * values[static_cast<Index>(k)];
  const Vector norms = columns.colwise().norm().transpose().cwiseMax(1e-300);
  columns *= norms.cwiseInverse().asDiagonal();
  const Vector x = nonnegative_least_squares(columns, -d.cwiseProduct(gradient), free);
  Vector nu = Vector::Zero(program.rows());
  for (std::size_t i = 0; i < active.size(); ++i)
    nu[active[i].row] += active[i].sign * x[static_cast<Index>(i)] / norms[static_cast<Index>(i)];
  return nu;
}

/// Recovers multipliers for several ideas of "active" and keeps those that the residuals like best. Beside multipliers
/// without bound, which least squares finds on rows that nearly depend on each other, any force looks balanced: they
/// are left out.
void judge_best(const Problem& problem, NonlinearProgram& program, const Callbacks& callbacks, const Vector& y,
                const Tolerances& tolerances, Result& result) {
  result.x = program.expand(y);
  result.multipliers = program.multipliers(y, Vector::Zero(program.rows()));
  Residuals best = residuals(problem, result);
  if (!best.finite || program.rows() == 0) return;
  const double largest_scale = 1e6 * best.force_scale;
  for (double distance : {1e-8, 1e-6, 1e-4}) {
    Result candidate = result;
    candidate.multipliers = program.multipliers(y, recovered(program, callbacks, y, distance));
    const Residuals judged = residuals(problem, candidate);
    if (!(judged.force_scale <= largest_scale && judged.over(tolerances) < best.over(tolerances))) continue;
    best = judged;
    result.multipliers = std::move(candidate.multipliers);
  }
}

/// One run of NLopt from y, which it moves to where NLopt ends; x and multipliers of `result` are those there.
nlopt_result improve(const Problem& problem, NonlinearProgram& program, const NloptOptions& options,
                     const Budget& budget, Vector& y, Result& result) {
  const Scaling scaling = scaling_of(program, y);
  Callbacks callbacks{program, scaling, budget, result};
  split_bounds(program, callbacks);
  Vector z = Vector::Zero(program.variables());
  nlopt_result code = NLOPT_SUCCESS;
  const bool finite = std::isfinite(scaling.f0) && scaling.d.allFinite() && scaling.row.allFinite();
  if (program.variables() > 0 && finite) code = optimise(options, callbacks, z);
  y = callbacks.unscaled(z.data());
  judge_best(problem, program, callbacks, y, options.tolerances, result);
  return code;
}

void say_unsolved(nlopt_result code, const Budget& budget, Result& result) {
  const std::string says = "NLopt says " + std::string(nlopt_result_to_string(code));
  if (code == NLOPT_FORCED_STOP) {
    result.status = budget.interrupted() ? Status::interrupted : Status::time_limit;
    result.message = budget.interrupted() ? "stopped on request" : "out of time";
  } else if (code == NLOPT_MAXEVAL_REACHED) {
    result.status = Status::iteration_limit;
    result.message = "evaluations used up";
  } else if (code == NLOPT_INVALID_ARGS) {
    result.status = Status::stalled;
    result.message = "more equations than unknowns, which NLopt refuses";
  } else {
    result.status = Status::stalled;
    result.overruled = code > 0;
    result.message = says + (result.overruled ? ", the residuals do not agree" : "");
  }
}

}  // namespace

std::string_view to_string(NloptAlgorithm algorithm) { return entry(algorithm).name; }
int largest_nlopt_problem(NloptAlgorithm algorithm) { return entry(algorithm).largest; }

void NloptOptions::validate() const {
  tolerances.validate();
  if (max_evaluations < 1) throw std::invalid_argument("NloptOptions: max_evaluations must be at least 1");
}

Nlopt::Nlopt(NloptOptions options) : options_(options) { options_.validate(); }

Result Nlopt::solve(const Problem& problem, const WarmStart& /*warm*/, const Budget& budget) {
  const Index unknowns = problem.size() - static_cast<Index>(problem.fixed_variables.size());
  if (unknowns > largest_nlopt_problem(options_.algorithm)) {
    throw std::invalid_argument("Nlopt: " + std::to_string(unknowns) + " free variables, " +
                                std::string(to_string(options_.algorithm)) + " takes at most " +
                                std::to_string(largest_nlopt_problem(options_.algorithm)));
  }
  Result result;
  double total = 0;
  {
    const Stopwatch watch(total);
    NonlinearProgram program(problem);
    nlopt_result code = NLOPT_SUCCESS;
    Vector y = program.start();
    double best = std::numeric_limits<double>::infinity();
    for (;;) {
      Result attempt;
      attempt.counts = result.counts;
      attempt.timings = result.timings;
      code = improve(problem, program, options_, budget, y, attempt);
      const double reached = residuals(problem, attempt).over(options_.tolerances);
      const bool better = reached < 0.5 * best || result.x.size() == 0;
      result.counts = attempt.counts;
      result.timings = attempt.timings;
      if (reached < best || result.x.size() == 0) {
        result.x = std::move(attempt.x);
        result.multipliers = std::move(attempt.multipliers);
        best = reached;
      }
      if (best <= 1 || !better || !std::isfinite(best) || code == NLOPT_FORCED_STOP || code == NLOPT_MAXEVAL_REACHED)
        break;
    }
    if (best <= 1) {
      result.status = Status::solved;
      result.message = "residuals within tolerance";
    } else if (!std::isfinite(best)) {
      result.status = Status::not_finite;
      result.message = "a value or derivative is not finite";
    } else {
      say_unsolved(code, budget, result);
    }
  }
  result.timings.total = total;
  return result;
}

}  // namespace taut
