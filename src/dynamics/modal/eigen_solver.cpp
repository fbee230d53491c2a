#include "dynamics/modal/eigen_solver.h"

#include <Spectra/SymGEigsShiftSolver.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "linalg/cholesky.h"

namespace taut {
namespace {

/// y = M x, as Spectra calls it.
struct MassProduct {
  using Scalar = double;
  const SparseMatrix& mass;

  Index rows() const { return mass.rows(); }
  Index cols() const { return mass.cols(); }
  void perform_op(const double* x, double* y) const {
    Eigen::Map<Vector>(y, rows()) = mass.selfadjointView<Eigen::Lower>() * Eigen::Map<const Vector>(x, rows());
  }
};

constexpr double final_tolerance = 1e-11;  // of Lanczos's method, on 1/(lambda + s)
constexpr double trial_tolerance = 1e-3;
constexpr int most_restarts = 500;

}  // namespace

/// (K + s M)^-1 for a shift s that makes it positive definite.
class EigenSolver::Shifted {
 public:
  /// Raises the shift until the matrix is definite. Throws std::runtime_error where none up to `most` is.
  Shifted(const SparseMatrix& stiffness, const SparseMatrix& mass, double shift, double most, int threads)
      : shift_(shift), cholesky_(SparseMatrix(stiffness + shift * mass), threads) {
    while (!cholesky_.factorize(SparseMatrix(stiffness + shift_ * mass))) {
      shift_ *= 10;
      if (!(shift_ <= most)) throw std::runtime_error("EigenSolver: no shift makes K + s M positive definite");
    }
  }
  double shift() const { return shift_; }
  void solve(const Vector& b, Vector& x) const { cholesky_.solve(b, x); }

 private:
  double shift_;
  mutable Cholesky cholesky_;
};

namespace {

/// y = Q (K + s M)^-1 x, Q the M-orthogonal projection off the pairs found; as Spectra calls it.
template <class Inverse>
struct DeflatedInverse {
  using Scalar = double;
  const Inverse& inverse;
  const MassProduct& mass;
  const std::vector<EigenPair>& found;

  Index rows() const { return mass.rows(); }
  Index cols() const { return mass.cols(); }
  void set_shift(double /*sigma*/) {}
  void perform_op(const double* x, double* y) const {
    Vector solution, product(rows());
    inverse.solve(Eigen::Map<const Vector>(x, rows()), solution);
    for (int pass = 0; pass < (found.empty() ? 0 : 2); ++pass) {  // twice is enough (Kahan)
      mass.perform_op(solution.data(), product.data());
      for (const EigenPair& pair : found) solution -= pair.vector.dot(product) * pair.vector;
    }
    Eigen::Map<Vector>(y, rows()) = solution;
  }
};

}  // namespace

EigenSolver::EigenSolver(const SparseMatrix& stiffness, const SparseMatrix& mass, int threads)
    : stiffness_(stiffness), mass_(mass), threads_(threads) {
  if (stiffness_.rows() != stiffness_.cols() || mass_.rows() != mass_.cols() || stiffness_.rows() != mass_.rows()) {
    throw std::invalid_argument("EigenSolver: expected two square matrices of one size, got " +
                                std::to_string(stiffness_.rows()) + " x " + std::to_string(stiffness_.cols()) +
                                " and " + std::to_string(mass_.rows()) + " x " + std::to_string(mass_.cols()));
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  start_ = Vector::Zero(mass_.rows());
  for (Index i = 0; i < mass_.rows(); ++i) {
    const double m = mass_.coeff(i, i);
    if (!(m > 0)) continue;
    ++size_;
    largest_ = std::max(largest_, std::abs(stiffness_.coeff(i, i)) / m);
    start_[i] = uniform(random);
  }
  if (size_ == 0) throw std::invalid_argument("EigenSolver: expected a mass, got none");
}

double EigenSolver::residual(const EigenPair& pair, double scale) const {
  const Vector inertia = mass_.selfadjointView<Eigen::Lower>() * pair.vector;
  const Vector force = stiffness_.selfadjointView<Eigen::Lower>() * pair.vector;
  return (force - pair.value * inertia).norm() / ((std::abs(pair.value) + scale) * inertia.norm());
}

std::vector<EigenPair> EigenSolver::search(const Shifted& inverse, int count, double tolerance,
                                           const std::vector<EigenPair>& found) const {
  const MassProduct product{mass_};
  DeflatedInverse<Shifted> operation{inverse, product, found};
  MassProduct metric = product;
  const int basis = std::min(size_ - static_cast<int>(found.size()), std::max(2 * count + 1, count + 20));
  Spectra::SymGEigsShiftSolver<DeflatedInverse<Shifted>, MassProduct, Spectra::GEigsMode::ShiftInvert> lanczos(
      operation, metric, count, basis, -inverse.shift());
  lanczos.init(start_.data());
  lanczos.compute(Spectra::SortRule::LargestMagn, most_restarts, tolerance, Spectra::SortRule::SmallestAlge);
  const Vector values = lanczos.eigenvalues();
  const Eigen::MatrixXd vectors = lanczos.eigenvectors();
  std::vector<EigenPair> pairs;
  for (Index k = 0; k < values.size(); ++k) {
    EigenPair pair{0, vectors.col(k), 0};
    const Vector inertia = mass_.selfadjointView<Eigen::Lower>() * pair.vector;
    pair.vector /= std::sqrt(pair.vector.dot(inertia));
    // Rayleigh's quotient has twice the digits of the value that the iteration gives.
    pair.value = pair.vector.dot(stiffness_.selfadjointView<Eigen::Lower>() * pair.vector);
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

std::vector<EigenPair> EigenSolver::find(int count) const {
  // A shift near the highest value asked for keeps them all apart from the rest, and K + s M far from singular.
  double shift = 1e-8 * largest_;
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Shifted inverse(stiffness_, mass_, shift, 10 * largest_, threads_);
    const std::vector<EigenPair> trial = search(inverse, count, trial_tolerance, {});
    double highest = 0;
    for (const EigenPair& pair : trial) highest = std::max(highest, std::abs(pair.value));
    if (trial.empty() || inverse.shift() != shift) {
      shift = trial.empty() ? 0.1 * inverse.shift() : inverse.shift();
      if (!trial.empty()) break;
      continue;
    }
    const bool fits = shift < 30 * highest && shift > 0.01 * highest;
    shift = std::max(highest, 1e-14 * largest_);
    if (fits) break;
  }
  const Shifted inverse(stiffness_, mass_, shift, 10 * largest_, threads_);
  std::vector<EigenPair> pairs = search(inverse, count, final_tolerance, {});
  if (static_cast<int>(pairs.size()) < count) {
    throw std::runtime_error("EigenSolver: " + std::to_string(pairs.size()) + " of " + std::to_string(count) +
                             " modes converged");
  }
  const auto by_value = [](const EigenPair& a, const EigenPair& b) { return a.value < b.value; };
  std::sort(pairs.begin(), pairs.end(), by_value);
  while (static_cast<int>(pairs.size()) < size_ - 1) {
    std::vector<EigenPair> more = search(inverse, 1, final_tolerance, pairs);
    if (more.empty() || !(more[0].value < pairs[static_cast<std::size_t>(count) - 1].value)) break;
    pairs.push_back(std::move(more[0]));
    std::sort(pairs.begin(), pairs.end(), by_value);
  }
  pairs.resize(static_cast<std::size_t>(count));
  return pairs;
}

std::vector<EigenPair> EigenSolver::lowest(int count) const {
  if (count < 1 || count >= size_) {
    throw std::invalid_argument("EigenSolver: expected a count from 1 to " + std::to_string(size_ - 1) + ", got " +
                                std::to_string(count));
  }
  // Where all are rigid motions their values are round-off; more are found then, for a scale of what a residual is.
  constexpr double rigid = 1e-13;  // over the largest value
  std::vector<EigenPair> pairs;
  double scale = 0;
  for (int asked = count; scale <= rigid * largest_; asked = std::min(2 * asked + 6, size_ - 1)) {
    pairs = find(asked);
    for (const EigenPair& pair : pairs) scale = std::max(scale, std::abs(pair.value));
    if (asked == size_ - 1) break;
  }
  pairs.resize(static_cast<std::size_t>(count));
  for (EigenPair& pair : pairs) pair.residual = residual(pair, scale);
  return pairs;
}

}  // namespace taut
