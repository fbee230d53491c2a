#include "dynamics/modal/eigen_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace taut {
namespace {

/// Masses of 1 on springs of stiffness 1: `chains` chains of `length` masses, each between two walls or free.
SparseMatrix chains(int count, int length, bool held) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int c = 0; c < count; ++c) {
    for (int i = 0; i < length; ++i) {
      const int row = c * length + i;
      const bool end = i == 0 || i == length - 1;
      entries.emplace_back(row, row, end && !held ? 1 : 2);
      if (i > 0) entries.emplace_back(row, row - 1, -1);
    }
  }
  SparseMatrix matrix(count * length, count * length);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

SparseMatrix unit(Index size, double value = 1) {
  SparseMatrix matrix(size, size);
  matrix.setIdentity();
  return value * matrix;
}

/// The k-th value, from 1, of a chain of n masses between two walls.
double held_value(int k, int n) { return std::pow(2 * std::sin(k * std::numbers::pi / (2 * (n + 1))), 2); }

void expect_pairs(const std::vector<EigenPair>& pairs, const SparseMatrix& mass) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_LE(pairs[i].residual, 1e-9) << i;
    for (std::size_t j = 0; j <= i; ++j) {
      const Vector product = mass.selfadjointView<Eigen::Lower>() * pairs[j].vector;
      EXPECT_NEAR(pairs[i].vector.dot(product), i == j ? 1 : 0, 1e-8) << i << " " << j;
    }
  }
}

TEST(EigenSolver, FindsTheValuesOfAChain) {
  const SparseMatrix mass = unit(60, 4);
  const std::vector<EigenPair> pairs = EigenSolver(chains(1, 60, true), mass, 1).lowest(7);
  ASSERT_EQ(pairs.size(), 7u);
  for (int k = 1; k <= 7; ++k) EXPECT_NEAR(pairs[k - 1].value, held_value(k, 60) / 4, 1e-12);
  expect_pairs(pairs, mass);
}

TEST(EigenSolver, FindsAValueAsOftenAsItOccurs) {
  const SparseMatrix mass = unit(200);
  const std::vector<EigenPair> pairs = EigenSolver(chains(5, 40, true), mass, 1).lowest(8);
  for (int k = 0; k < 8; ++k) EXPECT_NEAR(pairs[k].value, held_value(k < 5 ? 1 : 2, 40), 1e-12) << k;
  expect_pairs(pairs, mass);
}

TEST(EigenSolver, FindsTheRigidMotionsOfWhatFloats) {
  const std::vector<EigenPair> pairs = EigenSolver(chains(2, 50, false), unit(100), 1).lowest(4);
  for (int k = 0; k < 2; ++k) EXPECT_NEAR(pairs[k].value, 0, 1e-14);
  for (int k = 2; k < 4; ++k) EXPECT_NEAR(pairs[k].value, std::pow(2 * std::sin(std::numbers::pi / 100), 2), 1e-12);
  expect_pairs(pairs, unit(100));
}

TEST(EigenSolver, JudgesRigidMotionsByWhatVibrates) {
  const std::vector<EigenPair> pairs = EigenSolver(1e6 * chains(3, 40, false), unit(120), 1).lowest(2);
  for (const EigenPair& pair : pairs) EXPECT_NEAR(pair.value, 0, 1e-8);
  expect_pairs(pairs, unit(120));
}

TEST(EigenSolver, FindsValuesBelowZero) {
  SparseMatrix stiffness = chains(1, 60, true);
  stiffness.coeffRef(30, 30) = -3;
  const std::vector<EigenPair> pairs = EigenSolver(stiffness, unit(60), 1).lowest(3);
  EXPECT_LT(pairs[0].value, -3);
  EXPECT_GT(pairs[1].value, 0);
  expect_pairs(pairs, unit(60));
  const Eigen::MatrixXd dense = stiffness.selfadjointView<Eigen::Lower>() * Eigen::MatrixXd::Identity(60, 60);
  const Vector all = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(pairs[k].value, all[k], 1e-11);
}

TEST(EigenSolver, LeavesOutRowsWithoutMass) {
  SparseMatrix stiffness = chains(2, 20, true), mass = unit(40);
  for (int i = 20; i < 40; ++i) {
    mass.coeffRef(i, i) = 0;
    stiffness.coeffRef(i, i) = 1;
    if (i > 20) stiffness.coeffRef(i, i - 1) = 0;
  }
  const EigenSolver solver(stiffness, mass, 1);
  EXPECT_EQ(solver.size(), 20);
  const std::vector<EigenPair> pairs = solver.lowest(3);
  for (int k = 1; k <= 3; ++k) {
    EXPECT_NEAR(pairs[k - 1].value, held_value(k, 20), 1e-12);
    EXPECT_TRUE(pairs[k - 1].vector.tail(20).isZero(0));
  }
}

TEST(EigenSolver, SaysWhatDoesNotFit) {
  EXPECT_THROW(EigenSolver(chains(1, 5, true), unit(6), 1), std::invalid_argument);
  EXPECT_THROW(EigenSolver(chains(1, 5, true), unit(5, 0), 1), std::invalid_argument);
  const EigenSolver solver(chains(1, 5, true), unit(5), 1);
  EXPECT_THROW(solver.lowest(0), std::invalid_argument);
  EXPECT_THROW(solver.lowest(5), std::invalid_argument);
  EXPECT_NEAR(solver.lowest(4)[3].value, held_value(4, 5), 1e-12);
}

}  // namespace
}  // namespace taut
