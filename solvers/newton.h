#pragma once

#include <functional>
#include <limits>

#include "core/assembly.h"
#include "core/solver.h"
#include "linalg/cholesky.h"
#include "solvers/equality_rows.h"

namespace taut {

struct NewtonOptions {
  int max_iterations = 200;           ///< linear solves in one call
  int max_halvings = 40;              ///< of the step in one line search
  double sufficient_decrease = 1e-4;  ///< Armijo's constant
  double guard = 0.9;                 ///< fraction of the largest step that guarded elements allow
  /// No entry of a step exceeds this times max(1, |x|_inf): where the matrix is nearly singular, Newton's step is not
  /// to be believed. Infinity for scenes, whose masses bound it.
  double longest_step = std::numeric_limits<double>::infinity();
  void validate() const;
};

/// Where a minimisation stands.
struct NewtonState {
  Vector x;
  Vector multipliers;  ///< of the linear equalities, nu
  Vector gradient;     ///< of the value, plus A^T nu; zero at fixed variables
  Vector violation;    ///< A x - b
  double value = 0;
  double nodal_norm = 0;  ///< largest Euclidean norm of the gradient over nodes, N
};

/// Solves for Newton steps that keep the fixed variables, with the matrix H that an assembly holds.
class NewtonSystem {
 public:
  virtual ~NewtonSystem() = default;
  /// Factorises the matrix plus `shift` times the identity; false where that is not positive definite among the steps
  /// that keep fixed variables and equalities.
  virtual bool factorize(double shift) = 0;
  /// H step + A^T multiplier_step = -gradient and A step = -violation, A being the linear equalities; the fixed
  /// variables get zero.
  /// False where H turns out not to be positive definite.
  virtual bool solve(const Vector& gradient, const Vector& violation, Vector& step, Vector& multiplier_step) = 0;
  /// Of the next matrices: forces, in the Euclidean norm, N, that iterations may leave of a right-hand side. With 0,
  /// which is what holds at first, there are no iterations, and an indefinite matrix does not go unnoticed.
  virtual void allow(double /*force*/) {}
  /// True while weak couplings (Energy::couples_weakly) are left to iterations: none has failed since start().
  virtual bool iterates() const { return false; }
  /// A new minimisation begins: nothing learned from earlier matrices counts.
  virtual void start() {}

  /// Flops and nonzeros of the factor, and bytes of the kept structures; zero where unknown.
  struct Size {
    double factor_flops = 0, factor_nonzeros = 0;
    std::size_t bytes = 0;
  };
  virtual Size size() const { return {}; }
  /// What has happened inside so far.
  struct Effort {
    Index pivoted = 0;       ///< factorisations that needed pivoting
    Index iterations = 0;    ///< of conjugate gradients
    Index refactorized = 0;  ///< factorisations of the whole matrix after iterations that took too long
    double more_flops = 0;   ///< of factorisations, beyond size().factor_flops each
  };
  virtual Effort effort() const { return {}; }
};

/// Fixed variables substituted by the assembly itself, CHOLMOD in the order of its matrix; no equalities.
class SubstitutedSystem final : public NewtonSystem {
 public:
  /// The assembly has been put in the order that `cholesky` has analysed; both are borrowed.
  SubstitutedSystem(const Assembly& assembly, Cholesky& cholesky) : assembly_(assembly), cholesky_(cholesky) {}
  bool factorize(double shift) override { return cholesky_.factorize(assembly_.matrix(), shift); }
  bool solve(const Vector& gradient, const Vector& violation, Vector& step, Vector& multiplier_step) override;
  Size size() const override {
    return {cholesky_.factor_flops(), cholesky_.factor_nonzeros(), cholesky_.memory_bytes()};
  }

 private:
  const Assembly& assembly_;
  Cholesky& cholesky_;
  Vector right_hand_side_, solution_;
};

/// Semismooth Newton with an Armijo line search on a sum of energies. The exact Hessian is tried first; where it is not
/// positive definite or its step fails, the positive semidefinite one serves for some iterations. A shift is added
/// where even that is singular (slack static membranes). With linear equalities the exact one is shifted instead: their
/// covers buckle, and steps with the semidefinite Hessian, too stiff in just that direction, are short. Where there are
/// linear equalities, positions and their multipliers move together, and while they are violated the search is on value
/// + rho |A x - b|_1 with rho above every multiplier [Nocedal and Wright 2006, 18.3].
class Newton {
 public:
  /// `fixed` are the variables that stay; all is borrowed.
  Newton(Assembly& assembly, NewtonSystem& system, const EqualityRows& equalities, const std::vector<int>& fixed,
         int node_size, NewtonOptions options);
  /// Without linear equalities.
  Newton(Assembly& assembly, NewtonSystem& system, const std::vector<int>& fixed, int node_size, NewtonOptions options);

  /// Minimises from state.x and state.multipliers (fixed variables stay) until the equalities hold and done(state);
  /// returns solved, iteration_limit, stalled,
  /// not_finite, time_limit or interrupted. The state that `done` last saw is in `state`.
  Status minimise(NewtonState& state, const std::function<bool(const NewtonState&)>& done, const Budget& budget,
                  Counts& counts, Timings& timings);

 private:
  void evaluate(NewtonState& state, Counts& counts, Timings& timings);
  bool shifted_step(const std::function<bool(double)>& solve);
  bool direction(const NewtonState& state, Counts& counts, Timings& timings);
  bool line_search(NewtonState& state, Counts& counts, Timings& timings);

  double merit(const NewtonState& state) const { return state.value + weight_ * state.violation.lpNorm<1>(); }

  Assembly& assembly_;
  NewtonSystem& system_;
  const EqualityRows& equalities_;
  const std::vector<int>& fixed_;
  int node_size_;
  NewtonOptions options_;
  double weight_ = 0;  // rho
  double shift_ = 0;   // of the last exact Hessian, with equalities
  Vector step_, multiplier_step_;
  NewtonState trial_;
  Curvature curvature_ = Curvature::positive_semidefinite;
  int wait_ = 0;  // iterations before the exact Hessian is tried again
  int patience_ = 1;
};

/// The fraction of a step that NewtonOptions::longest_step leaves, at most 1.
double believable_fraction(const Vector& x, const Vector& step, double longest_step);

/// The largest Euclidean norm over nodes of `node_size` consecutive entries.
double nodal_max_norm(const Vector& force, int node_size);

}  // namespace taut
