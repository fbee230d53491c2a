#pragma once

#include <memory>
#include <vector>

#include "solvers/newton.h"

namespace taut {

/// Newton steps by conjugate gradients where some couplings are weak (Energy::couples_weakly): bending couples each
/// vertex with twice as many others as stretching does, and a factorisation with them takes about five times the flops
/// of one without. So the matrix H is preconditioned by the Cholesky factor of
///   B = H - C + diag(sum_j |C_ij|),
/// C being the weak couplings. B - H is diagonally dominant, hence H <= B: B is positive definite where H is, and no
/// eigenvalue of B^-1 H is above 1. Where those below are not small either, a few iterations come down to what allow()
/// has permitted. Where it takes too long (bending that is stiff beside the inertia) H itself is factorised, at once
/// from then on until start(); so it is where nothing is permitted.
class PreconditionedSystem final : public NewtonSystem {
 public:
  /// The assembly has been put in `order`, that of its graph which `cholesky` has analysed; both are borrowed.
  PreconditionedSystem(const Assembly& assembly, const std::vector<int>& order, Cholesky& cholesky, int threads);

  /// True where there are weak couplings and the mesh is not too fine.
  static bool pays(const Assembly& assembly);

  void allow(double force) override { allowed_ = force; }
  void start() override { direct_only_ = false; }
  bool iterates() const override { return !direct_only_; }
  bool factorize(double shift) override;
  bool solve(const Vector& gradient, const Vector& violation, Vector& step, Vector& multiplier_step) override;
  Size size() const override;
  Effort effort() const override { return effort_; }

 private:
  bool factorize_whole();
  void multiply(const Vector& v, Vector& product);

  const Assembly& assembly_;
  Cholesky& cholesky_;
  int threads_, group_size_;
  bool direct_only_ = false, direct_ = false;  // `direct_`: the last factorisation was of H
  double shift_ = 0, allowed_ = 0;
  SparseMatrix preconditioner_;  // B, in its own order
  std::vector<int> slots_;       // per entry of H: where it goes in B, or one of the two below
  static constexpr int ignored = -1, weak = -2;
  std::vector<int> diagonal_;         // per row of H: its diagonal entry in B
  std::vector<int> place_;            // per row of H: its row in B
  std::unique_ptr<Cholesky> factor_;  // of B
  int middle_;                        // group of columns of H up to which one thread multiplies, and another from there
  Vector other_half_;                 // of a product
  Vector right_hand_side_, solution_, placed_;
  Effort effort_;
};

}  // namespace taut
