#pragma once

#include <memory>
#include <vector>

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
  ~EliminatedSlack() override;

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

  /// The largest |c(to) - c(from)| of any element; infinite where that is no number.
  double largest_change(const Vector& from, const Vector& to) const;
  /// Leaves out the elements whose multipliers are zero and whose c(x) keeps more than `radius` to the boundary of
  /// their set. They add nothing to any sum, and their multipliers stay zero, until take_all_in(). Returns how many.
  Index leave_out(const Vector& x, double radius);
  void take_all_in();
  /// True where all are.
  bool is_left_out() const { return left_out_count_ == stencils().count(); }
  /// True where an element that is left out is violated at x, by however little.
  bool left_out_violated(const Vector& x) const;

  /// What evaluate() gives: the augmented Lagrangian above; or, on the central path (central_path.h) and at the point
  /// last given to set_point(), the gradient w J^T lambda and the matrix that is left of Newton's system for x and
  /// lambda after lambda is eliminated, with value 0.
  enum class Linearisation { augmented_lagrangian, central_path };
  void set_linearisation(Linearisation linearisation) { linearisation_ = linearisation; }
  /// How far lambda is from lambda_s, divided by the penalty: the largest over the elements, and the weighted mean
  /// square.
  struct Mismatch {
    double max = 0, mean_square = 0;
  };
  /// Evaluates the smoothed conditions lambda = lambda_s(x, lambda) at x, with epsilon the square of the smoothing
  /// width in the constraint's units squared.
  Mismatch set_point(const Vector& x, double epsilon, int threads);
  /// Aims the system linearised there at `target_epsilon` and adds to `gradient` what that leaves on its right-hand
  /// side.
  void aim(double target_epsilon, int threads, Vector& gradient);
  /// The change of lambda that belongs to the change dx of the linearised system.
  void multiplier_step(const Vector& dx, int threads, Vector& step) const;

  std::string name() const override { return constraint_.name(); }
  const Stencils& stencils() const override { return constraint_.stencils(); }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature curvature) const override;
  bool takes_four(Curvature /*curvature*/) const override {
    return linearisation_ == Linearisation::central_path && constraint_.takes_four();
  }
  Pack evaluate_four(Index quad, const Pack* x, Pack* gradient, Pack* hessian, Curvature curvature) const override;
  bool guards_steps() const override { return !is_left_out() && constraint_.guards_steps(); }
  double largest_step(Index element, const double* x, const double* dx) const override {
    return constraint_.largest_step(element, x, dx);
  }

 private:
  struct Path;
  bool left_out(Index element) const { return left_out_[static_cast<std::size_t>(element)] != 0; }
  void quad_multipliers(Index quad, Pack* lambda) const;
  Pack quad_weights(Index quad) const;
  bool quad_left_out(Index quad) const;
  void linearise(Index quad, const Pack* x, const Pack* lambda);
  double evaluate_path(Index element, const double* x, double* gradient, double* hessian, Curvature curvature) const;

  const Constraint& constraint_;
  Vector multipliers_;
  double penalty_ = 1;
  Vector weights_;              ///< per element
  std::vector<char> left_out_;  ///< per element
  Index left_out_count_ = 0;
  Linearisation linearisation_ = Linearisation::augmented_lagrangian;
  std::unique_ptr<Path> path_;  ///< what set_point() and aim() keep of every element
};

}  // namespace taut
