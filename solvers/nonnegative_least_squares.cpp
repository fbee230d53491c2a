#include "solvers/nonnegative_least_squares.h"

#include <Eigen/QR>
#include <algorithm>
#include <limits>

namespace taut {
namespace {

/// The least-squares solution on the chosen columns, zero elsewhere.
Vector solve_on(const Matrix& a, const Vector& b, const std::vector<Index>& columns) {
  Vector x = Vector::Zero(a.cols());
  if (!columns.empty()) x(columns) = Eigen::ColPivHouseholderQR<Matrix>(a(Eigen::all, columns)).solve(b);
  return x;
}

}  // namespace

Vector nonnegative_least_squares(const Matrix& a, const Vector& b, const std::vector<char>& free) {
  const Index count = a.cols();
  std::vector<Index> chosen;
  const auto admissible = [&](const Vector& x, Index i) { return free[static_cast<std::size_t>(i)] || x[i] > 0; };
  // Mostly all columns, or those that are positive then, are right; else the method starts from the free ones.
  for (Index i = 0; i < count; ++i) chosen.push_back(i);
  Vector x = solve_on(a, b, chosen);
  std::erase_if(chosen, [&](Index i) { return !admissible(x, i); });
  x = solve_on(a, b, chosen);
  if (!std::all_of(chosen.begin(), chosen.end(), [&](Index i) { return admissible(x, i); })) {
    std::erase_if(chosen, [&](Index i) { return !free[static_cast<std::size_t>(i)]; });
    x = solve_on(a, b, chosen);
  }
  for (Index round = 0; round < 3 * count; ++round) {
    const Vector slope = a.transpose() * (b - a * x);
    Index best = -1;
    double steepest = 1e-14 * b.norm() * a.norm();
    for (Index i = 0; i < count; ++i) {
      if (slope[i] <= steepest || std::find(chosen.begin(), chosen.end(), i) != chosen.end()) continue;
      steepest = slope[i];
      best = i;
    }
    if (best < 0) break;
    chosen.push_back(best);
    for (;;) {
      const Vector target = solve_on(a, b, chosen);
      // Towards the target as far as the signs allow; what becomes zero leaves.
      double fraction = 1;
      for (Index i : chosen)
        if (!admissible(target, i)) fraction = std::min(fraction, x[i] / (x[i] - target[i]));
      x += fraction * (target - x);
      if (fraction == 1) break;
      std::erase_if(chosen, [&](Index i) { return !admissible(target, i) && x[i] <= 1e-15 * x.cwiseAbs().maxCoeff(); });
      for (Index i = 0; i < count; ++i)
        if (std::find(chosen.begin(), chosen.end(), i) == chosen.end()) x[i] = 0;
    }
  }
  return x;
}

}  // namespace taut
