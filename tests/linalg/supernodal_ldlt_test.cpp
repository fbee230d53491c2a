#include "linalg/supernodal_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numeric>

#include "support/random_values.h"

namespace taut {
namespace {

/// The Laplacian of a grid with two right-hand neighbours of each cell, plus a quasi-definite border: `rows` sums over
/// random cells with -0.1 on their diagonal.
struct Specimen {
  Index size;
  std::vector<int> rows, columns, order;
  std::vector<double> entries;
  Matrix matrix;

  Specimen(int side, int borders) : size(side * side + borders) {
    const auto add = [&](int i, int j, double value) {
      rows.push_back(std::max(i, j));
      columns.push_back(std::min(i, j));
      entries.push_back(value);
    };
    for (int i = 0; i < side * side; ++i) {
      add(i, i, 4.1);
      if (i % side + 1 < side) add(i, i + 1, -1);
      if (i + side < side * side) add(i, i + side, -1);
    }
    for (int k = 0; k < borders; ++k) {
      const int row = side * side + k;
      add(row, row, -0.1);
      for (int i = k; i < side * side; i += 7) add(row, i, 0.3 + 0.01 * k);
    }
    matrix.setZero(size, size);
    for (std::size_t k = 0; k < entries.size(); ++k) {
      matrix(rows[k], columns[k]) += entries[k];
      if (rows[k] != columns[k]) matrix(columns[k], rows[k]) += entries[k];
    }
    order.resize(static_cast<std::size_t>(size));
    std::iota(order.begin(), order.end(), 0);
    // Odd ones first, so that supernodes of many widths come about.
    std::stable_partition(order.begin(), order.end(), [](int i) { return i % 2 == 1; });
  }
  Vector values() const { return Eigen::Map<const Vector>(entries.data(), static_cast<Index>(entries.size())); }
};

class SupernodalFactor : public testing::Test {
 protected:
  void SetUp() override {
    if (!SupernodalLdlt::available()) GTEST_SKIP() << "built without CHOLMOD's supernodal module";
  }
};

TEST_F(SupernodalFactor, SolvesQuasiDefiniteSystemsAndCountsTheirNegativeEigenvalues) {
  for (const int borders : {0, 1, 5}) {
    const Specimen specimen(17, borders);
    SupernodalLdlt factor(specimen.size, specimen.rows, specimen.columns, specimen.order);
    for (const double scale : {1.0, -3.0}) {
      ASSERT_TRUE(factor.factorize(scale * specimen.values()));
      EXPECT_EQ(factor.negative_pivots(), scale > 0 ? borders : specimen.size - borders);
      const Vector b = RandomValues(5).vector(specimen.size);
      Vector x = b;
      factor.solve(x);
      EXPECT_LE((scale * specimen.matrix * x - b).norm(), 1e-13 * b.norm());
    }
  }
}

TEST_F(SupernodalFactor, CountsNegativeEigenvaluesOfIndefiniteMatrices) {
  const Specimen specimen(9, 0);
  for (const double shift : {0.9, 2.3, 6.3}) {
    Vector values = specimen.values();
    for (std::size_t k = 0; k < specimen.rows.size(); ++k) {
      if (specimen.rows[k] == specimen.columns[k]) values[static_cast<Index>(k)] -= shift;
    }
    const Matrix shifted = specimen.matrix - shift * Matrix::Identity(specimen.size, specimen.size);
    const Vector eigenvalues = Eigen::SelfAdjointEigenSolver<Matrix>(shifted).eigenvalues();
    SupernodalLdlt factor(specimen.size, specimen.rows, specimen.columns, specimen.order);
    ASSERT_TRUE(factor.factorize(values));
    EXPECT_EQ(factor.negative_pivots(), (eigenvalues.array() < 0).count());
  }
}

TEST_F(SupernodalFactor, RefusesSmallPivotsAndWhatIsNotFinite) {
  // [e 1; 1 0] is regular, but not without pivoting.
  SupernodalLdlt factor(2, {0, 1, 1}, {0, 0, 1}, {0, 1});
  EXPECT_FALSE(factor.factorize(Vector3(1e-7, 1, 0)));
  EXPECT_FALSE(factor.factorize(Vector3(0, 1, 0)));
  EXPECT_TRUE(factor.factorize(Vector3(1e-5, 1, 0)));
  EXPECT_FALSE(factor.factorize(Vector3(1, 1, 1)));  // singular
  EXPECT_FALSE(factor.factorize(Vector3(1, std::numeric_limits<double>::quiet_NaN(), 3)));
  EXPECT_FALSE(factor.factorize(Vector3(std::numeric_limits<double>::infinity(), 1, 1)));
}

TEST_F(SupernodalFactor, TakesAnEmptyMatrix) {
  SupernodalLdlt factor(0, {}, {}, {});
  EXPECT_TRUE(factor.factorize(Vector()));
  Vector x;
  factor.solve(x);
  EXPECT_EQ(factor.negative_pivots(), 0);
}

}  // namespace
}  // namespace taut
