#pragma once

#include "core/constraint.h"
#include "core/energy.h"

namespace taut {

/// One constraint of the augmented Lagrangian with its slack eliminated, as an energy that any minimiser takes: with
/// y = c(x) + lambda/mu, P the projection onto K and lambda+ = mu (y - P y),
///   W_e = w_e (|lambda+|^2 - |lambda|^2)/(2 mu),  W_e' = w_e J^T lambda+,
///   W_e'' = w_e (sum lambda+ c'' + mu J^T (I - P') J).
/// For K an orthant this is SL (11)-(18); the update of the multiplier is lambda <- lambda+.
class EliminatedSlack final : public Energy {
 public:
  /// `constraint` is borrowed; multipliers start at zero.
  explicit EliminatedSlack(const Constraint& constraint);

  const Constraint& constraint() const { return constraint_; }
  /// One vector entry per row of each element.
  void set_multipliers(const Vector& multipliers);
  const Vector& multipliers() const { return multipliers_; }
  void set_penalty(double penalty) { penalty_ = penalty; }
  double penalty() const { return penalty_; }
  /// lambda+ of all elements at x, each element's capped at norm `cap`.
  void updated_multipliers(const Vector& x, double cap, Vector& updated) const;
  /// Adds w J^T (lambda+ - lambda) at x to `force`: how much the forces would change by an update now.
  void add_update_force(const Vector& x, Vector& force) const;

  /// What evaluate() linearises: the augmented Lagrangian above; or, for the central path (central_path.h), the
  /// conditions lambda = lambda_s(x, lambda) with the slack eliminated under a barrier, solved for x and lambda at once
  /// (`primal_dual`: gradient and matrix of the Newton system after lambda's elimination, value 0); or only w J^T
  /// lambda (`held`: gradient, value 0).
  enum class Linearisation { augmented_lagrangian, primal_dual, held };
  void set_linearisation(Linearisation linearisation) { linearisation_ = linearisation; }
  /// The square of the smoothing width, in the constraint's units squared; positive for `primal_dual`.
  void set_epsilon(double epsilon) { epsilon_ = epsilon; }
  /// How far lambda is from lambda_s at x, divided by the penalty: the largest over the elements, and the weighted mean
  /// square.
  struct Mismatch {
    double max = 0, mean_square = 0;
  };
  Mismatch mismatch(const Vector& x) const;
  /// The change of lambda that belongs to the change dx of the primal_dual system at x.
  void multiplier_step(const Vector& x, const Vector& dx, Vector& step) const;

  std::string name() const override { return constraint_.name(); }
  const Stencils& stencils() const override { return constraint_.stencils(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;
  bool guards_steps() const override { return constraint_.guards_steps(); }
  double largest_step(Index element, const double* x, const double* dx) const override {
    return constraint_.largest_step(element, x, dx);
  }

 private:
  struct PrimalDual;
  double evaluate_primal_dual(Index element, const double* x, double* gradient, double* hessian,
                              Curvature curvature) const;

  const Constraint& constraint_;
  Vector multipliers_;
  double penalty_ = 1;
  double epsilon_ = 0;
  Linearisation linearisation_ = Linearisation::augmented_lagrangian;
};

}  // namespace taut
