#include "core/assembly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "energies/dead_load.h"
#include "support/meshes.h"
#include "support/random_values.h"
#include "support/specimens.h"

namespace taut {
namespace {

/// Smooth coupling of any `width` variables: sum of cos(x_i) + sin(x_i x_j).
class Coupling final : public Energy {
 public:
  Coupling(int width, const std::vector<std::vector<int>>& elements) : stencils_(width) {
    for (const auto& element : elements) stencils_.add(element);
  }
  std::string name() const override { return "coupling"; }
  const Stencils& stencils() const override { return stencils_; }
  double evaluate(Index element, const double* x, double* gradient, double* hessian,
                  Curvature /*curvature*/) const override {
    const int n = stencils_.width();
    const double a = 1.0 + static_cast<double>(element);
    const Eigen::Map<const Vector> v(x, n);
    if (gradient) Eigen::Map<Vector>(gradient, n) = a * (v * v.squaredNorm());
    if (hessian)
      Eigen::Map<Matrix>(hessian, n, n) = a * (v.squaredNorm() * Matrix::Identity(n, n) + 2 * v * v.transpose());
    return 0.25 * a * std::pow(v.squaredNorm(), 2);
  }
  double largest_step(Index element, const double* /*x*/, const double* dx) const override {
    return dx[0] == 0 ? std::numeric_limits<double>::infinity()
                      : (1.0 + static_cast<double>(element)) / std::abs(dx[0]);
  }
  bool guards_steps() const override { return true; }

 private:
  Stencils stencils_;
};

struct DenseSum {
  double value = 0;
  Vector gradient;
  Matrix hessian;
};

/// The sum with plain loops, then rows and columns of fixed variables cleared.
DenseSum dense_sum(const std::vector<const Energy*>& energies, const Vector& x, const std::vector<int>& fixed,
                   Curvature curvature) {
  DenseSum sum{0, Vector::Zero(x.size()), Matrix::Zero(x.size(), x.size())};
  for (const Energy* energy : energies) {
    const Stencils& stencils = energy->stencils();
    Vector local(stencils.width()), gradient(stencils.width());
    Matrix hessian(stencils.width(), stencils.width());
    for (Index element = 0; element < stencils.count(); ++element) {
      stencils.gather(element, x, local.data());
      sum.value += energy->evaluate(element, local.data(), gradient.data(), hessian.data(), curvature);
      for (int i = 0; i < stencils.width(); ++i) {
        sum.gradient[stencils[element][i]] += gradient[i];
        for (int j = 0; j < stencils.width(); ++j)
          sum.hessian(stencils[element][i], stencils[element][j]) += hessian(i, j);
      }
    }
  }
  for (int variable : fixed) {
    sum.gradient[variable] = 0;
    sum.hessian.row(variable).setZero();
    sum.hessian.col(variable).setZero();
  }
  return sum;
}

/// The lower triangle of matrix() back in the order of the unknowns; unit rows of fixed variables become zero.
Matrix unordered(const Assembly& assembly, const std::vector<int>& fixed) {
  Matrix full = Matrix(assembly.matrix()).selfadjointView<Eigen::Lower>();
  Matrix out = Matrix::Zero(assembly.size(), assembly.size());
  Vector unit, image;
  for (Index column = 0; column < assembly.size(); ++column) {
    if (std::find(fixed.begin(), fixed.end(), column) != fixed.end()) continue;
    assembly.to_ordered(Vector::Unit(assembly.size(), column), unit);
    assembly.from_ordered(full * unit, image);
    out.col(column) = image;
  }
  return out;
}

std::vector<int> shuffled(int count, unsigned seed) {
  std::vector<int> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(seed));
  return order;
}

void expect_dense_sum(const std::vector<const Energy*>& energies, const Vector& x, const std::vector<int>& fixed) {
  for (int threads : {1, 2, 3}) {
    Assembly assembly(x.size(), energies, fixed, threads);
    for (int seed = -1; seed < 2; ++seed) {  // -1: the natural order
      if (seed >= 0) assembly.set_order(shuffled(assembly.graph().count(), static_cast<unsigned>(seed)));
      for (Curvature curvature : {Curvature::exact, Curvature::positive_semidefinite}) {
        const DenseSum expected = dense_sum(energies, x, fixed, curvature);
        Vector gradient;
        EXPECT_NEAR(assembly.value(x), expected.value, 1e-13 * std::abs(expected.value));
        EXPECT_EQ(assembly.gradient(x, gradient), assembly.value(x));
        EXPECT_LE((gradient - expected.gradient).norm(), 1e-13 * expected.gradient.norm());
        assembly.hessian(x, curvature);
        EXPECT_LE((unordered(assembly, fixed) - expected.hessian).norm(), 1e-13 * expected.hessian.norm())
            << threads << " " << seed;
      }
    }
  }
}

bool made_of_vertices(const Stencils& stencils) {
  for (Index element = 0; element < stencils.count(); ++element) {
    for (int k = 0; k < stencils.width(); ++k) {
      if (stencils[element][k] % 3 != k % 3) return false;
    }
  }
  return stencils.width() % 3 == 0;
}

/// All energies on the specimen sheet, two of each: those share their elements.
struct Sheet {
  std::vector<std::shared_ptr<const Energy>> owned;
  std::vector<const Energy*> energies;
  Vector x = posed(Pose::stretched);
  Sheet() {
    for (const EnergySpecimen& specimen : energy_specimens()) {
      if (specimen.posed(Pose::stretched).size() != x.size()) continue;  // on another mesh
      const std::shared_ptr<const Energy> energy = specimen.make();
      if (!made_of_vertices(energy->stencils())) continue;  // modes
      owned.push_back(energy);
      energies.push_back(owned.back().get());
    }
    for (const auto& energy : owned) energies.push_back(energy.get());
  }
};

TEST(Assembly, IsTheDenseSumOnVertices) {
  const Sheet sheet;
  expect_dense_sum(sheet.energies, sheet.x, {});
}

TEST(Assembly, IsTheDenseSumWithVerticesFullyAndPartlyFixed) {
  const Sheet sheet;
  expect_dense_sum(sheet.energies, sheet.x, {0, 1, 2, 4, 12, 13, 14, 25, 26});
}

TEST(Assembly, IsTheDenseSumOnSingleVariables) {
  const Coupling odd(2, {{0, 3}, {3, 4}, {1, 0}, {6, 5}}), lone(1, {{2}, {6}});
  const Vector x = RandomValues(1).vector(7);
  expect_dense_sum({&odd, &lone}, x, {});
  expect_dense_sum({&odd, &lone}, x, {0, 6});
}

TEST(Assembly, TreatsVariablesSinglyWhereAStencilIsNotMadeOfVertices) {
  const Coupling vertices(6, {{0, 1, 2, 6, 7, 8}}), skewed(3, {{2, 3, 4}});
  const Vector x = RandomValues(2).vector(9);
  expect_dense_sum({&vertices, &skewed}, x, {7});
}

TEST(Assembly, HasNothingToSolveForWhereEverythingIsFixed) {
  const Coupling coupling(2, {{0, 1}});
  Assembly assembly(2, {&coupling}, {0, 1}, 2);
  EXPECT_EQ(assembly.ordered_size(), 0);
  Vector gradient;
  const Vector x = Vector::Ones(2);
  EXPECT_DOUBLE_EQ(assembly.gradient(x, gradient), 1.0);
  EXPECT_EQ(gradient, Vector::Zero(2));
  EXPECT_NO_THROW(assembly.hessian(x, Curvature::exact));
}

TEST(Assembly, GivesPartlyFixedVerticesDecoupledUnitRows) {
  const Sheet sheet;
  Assembly assembly(sheet.x.size(), sheet.energies, {4}, 1);
  assembly.hessian(sheet.x, Curvature::exact);
  const Matrix matrix = Matrix(assembly.matrix()).selfadjointView<Eigen::Lower>();
  EXPECT_EQ(Vector(matrix.col(4)), Vector(Vector::Unit(matrix.rows(), 4)));
}

TEST(Assembly, LeavesEnergiesWithoutCurvatureOutOfTheGraph) {
  const DeadLoad load("load", Vector::Ones(6));
  EXPECT_EQ(Assembly(6, {&load}, {}, 1).graph().neighbours.size(), 0u);
}

TEST(Assembly, GraphIsSymmetricAscendingAndWithoutLoops) {
  const Sheet sheet;
  const Assembly assembly(sheet.x.size(), sheet.energies, {0, 1, 2}, 1);
  const GroupGraph& graph = assembly.graph();
  EXPECT_EQ(graph.count(), sheet.x.size() / 3 - 1);
  const auto list = [&](int g) {
    return std::vector<int>(graph.neighbours.begin() + graph.starts[static_cast<std::size_t>(g)],
                            graph.neighbours.begin() + graph.starts[static_cast<std::size_t>(g) + 1]);
  };
  for (int g = 0; g < graph.count(); ++g) {
    const std::vector<int> neighbours = list(g);
    EXPECT_TRUE(std::is_sorted(neighbours.begin(), neighbours.end()));
    for (int other : neighbours) {
      EXPECT_NE(other, g);
      const std::vector<int> back = list(other);
      EXPECT_TRUE(std::binary_search(back.begin(), back.end(), g));
    }
  }
}

TEST(Assembly, GivesTheSameBitsForOneTwoAndThreeThreadsAndEveryTime) {
  const Sheet sheet;
  const std::vector<int> fixed{0, 1, 2, 10};
  std::vector<Assembly> assemblies;
  for (int threads : {1, 1, 2, 3}) {
    assemblies.emplace_back(sheet.x.size(), sheet.energies, fixed, threads);
    assemblies.back().set_order(shuffled(assemblies.back().graph().count(), 5));
  }
  Vector first, gradient;
  assemblies[0].hessian(sheet.x, Curvature::exact);
  const double value = assemblies[0].gradient(sheet.x, first);
  for (Assembly& assembly : assemblies) {
    for (int repeat = 0; repeat < 20; ++repeat) {
      EXPECT_EQ(assembly.gradient(sheet.x, gradient), value);
      EXPECT_EQ(assembly.value(sheet.x), value);
      EXPECT_EQ(gradient, first);
      assembly.hessian(sheet.x, Curvature::exact);
      const Index n = assembly.matrix().nonZeros();
      ASSERT_EQ(n, assemblies[0].matrix().nonZeros());
      EXPECT_TRUE(std::equal(assembly.matrix().valuePtr(), assembly.matrix().valuePtr() + n,
                             assemblies[0].matrix().valuePtr()));
    }
  }
}

TEST(Assembly, ReusesTheMemoryOfItsMatrix) {
  const Sheet sheet;
  Assembly assembly(sheet.x.size(), sheet.energies, {}, 1);
  const double* values = assembly.matrix().valuePtr();
  const std::size_t bytes = assembly.memory_bytes();
  assembly.hessian(sheet.x, Curvature::exact);
  assembly.hessian(2 * sheet.x, Curvature::positive_semidefinite);
  EXPECT_EQ(assembly.matrix().valuePtr(), values);
  EXPECT_EQ(assembly.memory_bytes(), bytes);
}

TEST(Assembly, TakesTheShortestOfTheGuardedSteps) {
  const Coupling coupling(1, {{0}, {1}});
  const Assembly assembly(2, {&coupling}, {}, 1);
  EXPECT_DOUBLE_EQ(assembly.largest_step(Vector::Zero(2), Vector2(0.25, 1)), 2.0);
  EXPECT_EQ(assembly.largest_step(Vector::Zero(2), Vector2(0, 0)), std::numeric_limits<double>::infinity());
}

TEST(Assembly, RejectsThreadsAndOrdersThatDoNotFit) {
  const Coupling coupling(1, {{0}, {1}});
  EXPECT_THROW(Assembly(2, {&coupling}, {}, 0), std::invalid_argument);
  EXPECT_THROW(Assembly(2, {&coupling}, {}, 256), std::invalid_argument);
  Assembly assembly(2, {&coupling}, {}, 1);
  EXPECT_THROW(assembly.set_order({0}), std::invalid_argument);
  EXPECT_THROW(assembly.set_order({1, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace taut
