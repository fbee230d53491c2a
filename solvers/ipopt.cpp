#include "solvers/ipopt.h"

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <IpTimingStatistics.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>
#include <tuple>

#include "core/stopwatch.h"
#include "solvers/nonlinear_program.h"

namespace taut {
namespace {

using Number = ::Ipopt::Number;
using Int = ::Ipopt::Index;
using ::Ipopt::ApplicationReturnStatus;

constexpr double no_bound = 1e20;  // Ipopt: anything from 1e19 on is infinite

/// What Ipopt calls back. An exception cannot pass through Ipopt: it is kept, and Ipopt is told to stop.
class Callbacks final : public ::Ipopt::TNLP {
 public:
  Callbacks(NonlinearProgram& program, double force_scale, Vector start, Vector nu, const Budget& budget,
            Result& result, const std::function<void(const Iterate&)>& observer)
      : program_(program),
        scale_(force_scale),
        y_(std::move(start)),
        nu_(std::move(nu)),
        budget_(budget),
        result_(result),
        observer_(observer),
        iterations_before_(result.counts.outer) {}

  const Vector& y() const { return y_; }
  const Vector& nu() const { return nu_; }
  bool out_of_budget() const { return stopped_; }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

  bool get_nlp_info(Int& n, Int& m, Int& jacobian, Int& hessian, IndexStyleEnum& style) override {
    n = static_cast<Int>(program_.variables());
    m = static_cast<Int>(program_.rows());
    jacobian = static_cast<Int>(program_.jacobian_pattern().rows.size());
    hessian = static_cast<Int>(program_.hessian_pattern().rows.size());
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Int n, Number* x_l, Number* x_u, Int m, Number* g_l, Number* g_u) override {
    std::fill_n(x_l, n, -no_bound);
    std::fill_n(x_u, n, no_bound);
    for (Int i = 0; i < m; ++i) {
      g_l[i] = std::max(program_.lower()[i], -no_bound);
      g_u[i] = std::min(program_.upper()[i], no_bound);
    }
    return true;
  }

  bool get_starting_point(Int n, bool, Number* x, bool, Number* z_l, Number* z_u, Int m, bool init_lambda,
                          Number* lambda) override {
    std::copy_n(y_.data(), n, x);
    if (z_l) std::fill_n(z_l, n, 0.0);
    if (z_u) std::fill_n(z_u, n, 0.0);
    if (init_lambda)
      for (Int i = 0; i < m; ++i) lambda[i] = nu_[i] / scale_;
    return true;
  }

  bool eval_f(Int n, const Number* x, bool, Number& value) override {
    return guarded([&] {
      ++result_.counts.function_evaluations;
      value = program_.objective(Eigen::Map<const Vector>(x, n)) / scale_;
      return std::isfinite(value);
    });
  }

  bool eval_grad_f(Int n, const Number* x, bool, Number* gradient) override {
    return guarded([&] {
      program_.gradient(Eigen::Map<const Vector>(x, n), scratch_);
      return give(scratch_ / scale_, gradient);
    });
  }

  bool eval_g(Int n, const Number* x, bool, Int, Number* g) override {
    return guarded([&] {
      program_.constraints(Eigen::Map<const Vector>(x, n), scratch_);
      return give(scratch_, g);
    });
  }

  bool eval_jac_g(Int n, const Number* x, bool, Int, Int, Int* row, Int* column, Number* values) override {
    if (!values) return give_pattern(program_.jacobian_pattern(), row, column);
    return guarded([&] {
      program_.jacobian(Eigen::Map<const Vector>(x, n), scratch_);
      return give(scratch_, values);
    });
  }

  bool eval_h(Int n, const Number* x, bool, Number factor, Int m, const Number* lambda, bool, Int, Int* row,
              Int* column, Number* values) override {
    if (!values) return give_pattern(program_.hessian_pattern(), row, column);
    return guarded([&] {
      ++result_.counts.factorizations;
      program_.hessian(Eigen::Map<const Vector>(x, n), factor / scale_, Eigen::Map<const Vector>(lambda, m), scratch_);
      return give(scratch_, values);
    });
  }

  bool intermediate_callback(::Ipopt::AlgorithmMode, Int iteration, Number, Number, Number, Number, Number, Number,
                             Number, Number, Int, const ::Ipopt::IpoptData* data,
                             ::Ipopt::IpoptCalculatedQuantities* quantities) override {
    if (observer_) {
      guarded([&] {
        show(iteration, *data, *quantities);
        return true;
      });
    }
    stopped_ = budget_.interrupted() || budget_.out_of_time();
    return !failure_ && !stopped_;
  }

  void finalize_solution(::Ipopt::SolverReturn, Int n, const Number* x, const Number*, const Number*, Int m,
                         const Number*, const Number* lambda, Number, const ::Ipopt::IpoptData*,
                         ::Ipopt::IpoptCalculatedQuantities*) override {
    y_ = Eigen::Map<const Vector>(x, n);
    nu_ = scale_ * Eigen::Map<const Vector>(lambda, m);
  }

 private:
  /// Shows the observer the current point, unless that belongs to the restoration phase's own problem.
  void show(Int iteration, const ::Ipopt::IpoptData& data, ::Ipopt::IpoptCalculatedQuantities& quantities) {
    auto* posed = dynamic_cast<::Ipopt::OrigIpoptNLP*>(::Ipopt::GetRawPtr(quantities.GetIpoptNLP()));
    auto* adapter = posed ? dynamic_cast<::Ipopt::TNLPAdapter*>(::Ipopt::GetRawPtr(posed->nlp())) : nullptr;
    if (!adapter) return;
    Vector y(program_.variables()), nu(program_.rows());
    adapter->ResortX(*data.curr()->x(), y.data());
    adapter->ResortG(*data.curr()->y_c(), *data.curr()->y_d(), nu.data());
    result_.counts.outer = result_.counts.linear_solves = iterations_before_ + iteration;
    observer_({program_.expand(y), program_.multipliers(y, scale_ * nu), 0, result_.counts});
  }

  template <class Work>
  bool guarded(const Work& work) {
    if (failure_) return false;
    const Stopwatch watch(result_.timings.assembly);
    try {
      return work();
    } catch (...) {
      failure_ = std::current_exception();
      return false;
    }
  }
  /// False, which makes Ipopt shorten its step, where something is not finite.
  static bool give(const Vector& values, Number* target) {
    std::copy_n(values.data(), values.size(), target);
    return values.allFinite();
  }
  static bool give_pattern(const TripletPattern& pattern, Int* row, Int* column) {
    std::copy(pattern.rows.begin(), pattern.rows.end(), row);
    std::copy(pattern.columns.begin(), pattern.columns.end(), column);
    return true;
  }

  NonlinearProgram& program_;
  double scale_;
  Vector y_, nu_, scratch_;
  const Budget& budget_;
  Result& result_;
  const std::function<void(const Iterate&)>& observer_;
  std::int64_t iterations_before_;
  bool stopped_ = false;
  std::exception_ptr failure_;
};

/// Sets options; Ipopt itself says false to a mistake and goes on without.
struct Settings {
  ::Ipopt::IpoptApplication& application;

  void set(const std::string& key, const char* value) { check(key, application.Options()->SetStringValue(key, value)); }
  void set(const std::string& key, double value) { check(key, application.Options()->SetNumericValue(key, value)); }
  void set(const std::string& key, int value) { check(key, application.Options()->SetIntegerValue(key, value)); }
  static void check(const std::string& key, bool taken) {
    if (!taken) throw std::logic_error("Ipopt does not take the option " + key);
  }
};

void configure(const IpoptOptions& options, const char* guard, bool warm, ::Ipopt::IpoptApplication& application) {
  Settings settings{application};
  const Tolerances& t = options.tolerances;
  settings.set("sb", "yes");
  settings.set("print_level", 0);
  settings.set("max_iter", options.max_iterations);
  // The program comes scaled. The judge takes bounds as they are, and wants every element's complementarity, of which
  // Ipopt's products are the square where multiplier and gap are equally small.
  settings.set("nlp_scaling_method", "none");
  settings.set("bound_relax_factor", 0.0);
  settings.set("honor_original_bounds", "no");
  settings.set("acceptable_iter", 0);
  settings.set("dual_inf_tol", 0.1 * t.stationarity);
  settings.set("constr_viol_tol", 1e-3 * t.feasibility);
  settings.set("compl_inf_tol", std::max(1e-2 * t.complementarity * t.complementarity, 1e-16));
  settings.set("tol", std::max(1e-2 * std::min({t.stationarity, t.feasibility, t.complementarity}), 1e-14));
  // Measured: three to ten times fewer iterations than with a barrier that only falls.
  settings.set("mu_strategy", "adaptive");
  settings.set("adaptive_mu_globalization", guard);
  if (!warm) return;
  settings.set("warm_start_init_point", "yes");
  settings.set("mu_init", options.warm_barrier);
  for (const char* push : {"warm_start_bound_push", "warm_start_bound_frac", "warm_start_slack_bound_push",
                           "warm_start_slack_bound_frac", "warm_start_mult_bound_push"})
    settings.set(push, options.warm_barrier);
}

/// penalty (z - P z) with z = c + lambda/penalty: in the normal cone of every element, and zero where the gap exceeds
/// lambda/penalty.
Vector projected(const Constraint& constraint, const Vector& x, const Vector& lambda, double penalty) {
  const int rows = constraint.rows();
  Vector local(constraint.stencils().width());
  std::array<double, max_rows> c, nearest;
  Vector result(lambda.size());
  for (Index element = 0; element < constraint.stencils().count(); ++element) {
    constraint.stencils().gather(element, x, local.data());
    constraint.evaluate(element, local.data(), c.data(), nullptr);
    Vector z = Eigen::Map<const Vector>(c.data(), rows) + lambda.segment(element * rows, rows) / penalty;
    constraint.set().project(element, z.data(), nearest.data(), nullptr);
    result.segment(element * rows, rows) = penalty * (z - Eigen::Map<const Vector>(nearest.data(), rows));
  }
  return result;
}

/// Keeps the multipliers as they are or projects them, as the residuals prefer; returns the residuals.
Residuals judge_best(const Problem& problem, const Tolerances& tolerances, Result& result) {
  Residuals best = residuals(problem, result);
  const std::vector<Vector> raw = result.multipliers;
  for (double factor : {1e-2, 1.0, 1e2, 1e4}) {
    Result candidate = result;
    for (std::size_t k = 0; k < problem.constraints.size(); ++k) {
      const double largest = raw[k].size() ? raw[k].lpNorm<Eigen::Infinity>() : 0.0;
      if (largest > 0)
        candidate.multipliers[k] = projected(*problem.constraints[k], result.x, raw[k], factor * largest);
    }
    const Residuals judged = residuals(problem, candidate);
    if (!(judged.over(tolerances) < best.over(tolerances))) continue;
    best = judged;
    result.multipliers = std::move(candidate.multipliers);
  }
  return best;
}

/// Guards of the adaptive barrier, tried in this order: a filter of objective and violation, Ipopt's default, and the
/// whole optimality error. Either loses steps that the other solves (docs/guide/solvers.md); the first is faster.
constexpr std::array<const char*, 2> guards{"obj-constr-filter", "kkt-error"};

bool claims_success(ApplicationReturnStatus ending) {
  return ending == ::Ipopt::Solve_Succeeded || ending == ::Ipopt::Solved_To_Acceptable_Level ||
         ending == ::Ipopt::Feasible_Point_Found;
}

/// Status and message of an ending that the residuals do not call solved.
std::pair<Status, const char*> unsolved(ApplicationReturnStatus ending) {
  if (claims_success(ending)) return {Status::stalled, "Ipopt claims success, the residuals do not agree"};
  switch (ending) {
    case ::Ipopt::Infeasible_Problem_Detected:
      return {Status::infeasible, "Ipopt converged to a point of local infeasibility"};
    case ::Ipopt::Diverging_Iterates:
      return {Status::unbounded, "Ipopt's iterates diverge"};
    case ::Ipopt::Maximum_Iterations_Exceeded:
      return {Status::iteration_limit, "Ipopt's iterations are used up"};
    case ::Ipopt::Maximum_CpuTime_Exceeded:
      return {Status::time_limit, "out of time"};
    case ::Ipopt::Invalid_Number_Detected:
      return {Status::not_finite, "a value or derivative is not finite at Ipopt's point"};
    case ::Ipopt::Search_Direction_Becomes_Too_Small:
      return {Status::stalled, "Ipopt's search direction becomes too small"};
    case ::Ipopt::Restoration_Failed:
      return {Status::stalled, "Ipopt's restoration phase failed"};
    case ::Ipopt::Error_In_Step_Computation:
      return {Status::stalled, "Ipopt could not compute a step"};
    case ::Ipopt::Not_Enough_Degrees_Of_Freedom:
      return {Status::stalled, "Ipopt refuses more equations than free variables"};
    case ::Ipopt::Insufficient_Memory:
      throw std::bad_alloc();
    default:
      throw std::runtime_error("Ipopt ended with its status " + std::to_string(ending));
  }
}

/// Status and message of an attempt: the residuals come first, then what stopped it.
std::pair<Status, const char*> verdict(const Residuals& judged, const Tolerances& tolerances,
                                       ApplicationReturnStatus ending, bool out_of_budget, const Budget& budget) {
  if (judged.within(tolerances)) return {Status::solved, "residuals within tolerance"};
  if (out_of_budget) {
    return budget.interrupted() ? std::pair(Status::interrupted, "stopped on request")
                                : std::pair(Status::time_limit, "out of time");
  }
  if (!judged.finite) return {Status::not_finite, "a value or derivative is not finite at the last point"};
  return unsolved(ending);
}

/// Adds the iterations and seconds of a run to those `before` it.
void add_statistics(::Ipopt::IpoptApplication& application, const Counts& before, Result& result) {
  const auto statistics = application.Statistics();
  if (!::Ipopt::IsValid(statistics)) return;
  result.counts.outer = before.outer + statistics->IterationCount();
  result.counts.linear_solves = before.linear_solves + statistics->IterationCount();
  auto& seconds = application.IpoptDataObject()->TimingStats();
  const double symbolic = seconds.LinearSystemSymbolicFactorization().TotalWallclockTime();
  const double solve = seconds.LinearSystemBackSolve().TotalWallclockTime();
  result.timings.analysis += symbolic;
  result.timings.solve += solve;
  // Ipopt's timer of the factorisation stays zero with MUMPS; what is left of its linear systems is that.
  result.timings.factorization += std::max(seconds.PDSystemSolverTotal().TotalWallclockTime() - solve - symbolic, 0.0);
}

}  // namespace

void IpoptOptions::validate() const {
  tolerances.validate();
  if (max_iterations < 1) throw std::invalid_argument("IpoptOptions: max_iterations must be at least 1");
  if (!(warm_barrier > 0)) throw std::invalid_argument("IpoptOptions: warm_barrier must be positive");
}

struct Ipopt::Workspace {
  NonlinearProgram program;
  explicit Workspace(const Problem& problem) : program(problem) {}
};

Ipopt::Ipopt(IpoptOptions options) : options_(options) { options_.validate(); }
Ipopt::~Ipopt() = default;

Result Ipopt::solve(const Problem& problem, const WarmStart& warm, const Budget& budget) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  Result result;
  double total = 0;
  {
    const Stopwatch watch(total);
    if (workspace_ && workspace_->program.fits(problem)) {
      workspace_->program.update(problem);
    } else {
      const Stopwatch analysis(result.timings.analysis);
      workspace_ = std::make_unique<Workspace>(problem);
      result.counts.matrix_allocations = 1;
    }
    run(problem, warm, budget, result);
  }
  result.timings.total = total;
  return result;
}

void Ipopt::run(const Problem& problem, const WarmStart& warm, const Budget& budget, Result& result) {
  NonlinearProgram& program = workspace_->program;
  const Vector start = program.start();
  result.x = program.expand(start);
  result.multipliers = program.multipliers(start, Vector::Zero(program.rows()));
  const double force_scale = residuals(problem, result).force_scale;
  const bool use_warm = options_.warm_start && program.rows() > 0 && !warm.multipliers.empty();
  const Vector nu = use_warm ? program.row_multipliers(start, warm.multipliers) : Vector::Zero(program.rows());
  const double scale = std::isfinite(force_scale) && force_scale > 0 ? force_scale : 1.0;
  result.counts.symbolic_analyses = 1;

  Residuals best;
  for (const char* guard : guards) {
    ::Ipopt::SmartPtr<::Ipopt::IpoptApplication> application = new ::Ipopt::IpoptApplication(false);
    configure(options_, guard, use_warm, *application);
    application->Initialize("");  // no options file, whatever lies in the working directory
    const ::Ipopt::SmartPtr<Callbacks> callbacks = new Callbacks(program, scale, start, nu, budget, result, observer);
    const Counts before = result.counts;
    ApplicationReturnStatus ending = ::Ipopt::Solve_Succeeded;  // nothing free: nothing to do
    if (program.variables() > 0) ending = application->OptimizeTNLP(::Ipopt::GetRawPtr(callbacks));
    callbacks->rethrow();
    add_statistics(*application, before, result);

    Result candidate;
    candidate.x = program.expand(callbacks->y());
    candidate.multipliers = program.multipliers(callbacks->y(), callbacks->nu());
    const Residuals judged = judge_best(problem, options_.tolerances, candidate);
    const bool out_of_budget = callbacks->out_of_budget();
    const auto [status, message] = verdict(judged, options_.tolerances, ending, out_of_budget, budget);
    const bool better = guard == guards.front() || judged.over(options_.tolerances) < best.over(options_.tolerances);
    if (better) {
      best = judged;
      result.x = std::move(candidate.x);
      result.multipliers = std::move(candidate.multipliers);
      result.overruled = status == Status::stalled && claims_success(ending);
    }
    if (better || out_of_budget) {
      result.status = status;
      result.message = message;
    }
    if (status != Status::stalled && status != Status::iteration_limit) break;
  }
}

}  // namespace taut
