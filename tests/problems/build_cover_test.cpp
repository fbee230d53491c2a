#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "energies/hinge_bending.h"
#include "energies/membrane.h"
#include "geometry/grid.h"
#include "geometry/prolongation.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "support/meshes.h"

namespace taut {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::string file(const std::string& name) { return std::string(TAUT_CATALOGUE) + "/" + name + ".json"; }

std::string refusal(const std::string& problem, const Overrides& overrides) {
  try {
    build_model(read_scene(file(problem), overrides));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Cover, IsABodyOfItsOwnBehindItsShell) {
  const auto model = build_model(read_scene(file("quilt"), {{"bodies.quilt.cover.mesh.refine", "1"}}));
  ASSERT_EQ(model->bodies.size(), 2u);
  EXPECT_EQ(model->bodies[1].name, "quilt/cover");
  EXPECT_EQ(model->bodies[0].vertices, 81 * 3);
  EXPECT_EQ(model->bodies[1].vertices, 17 * 17);
  ASSERT_EQ(model->equalities.size(), 1u);
  EXPECT_EQ(model->equalities[0]->rows.rows(), 3 * 81);
  // The start is compatible, imperfection and all.
  EXPECT_LE((model->equalities[0]->rows * model->positions).lpNorm<Eigen::Infinity>(), 1e-15);
  EXPECT_THAT(model->notes, IsEmpty());
}

TEST(Cover, IsOnTheSurfaceAskedFor) {
  for (const auto& [surface, height] : {std::pair("top", 0.015), {"bottom", -0.015}, {"mid", 0.0}}) {
    const auto model = build_model(read_scene(file("quilt"), {{"bodies.quilt.cover.surface", surface}}));
    double sum = 0;
    const BodyRange& cover = model->bodies[1];
    for (int v = cover.first_vertex; v < cover.first_vertex + cover.vertices; ++v) sum += model->positions[3 * v + 2];
    // The layers have a third and two thirds of the thickness; "mid" of two prisms is the node between them.
    const double expected = std::string(surface) == "mid" ? -0.005 : height;
    EXPECT_NEAR(sum / cover.vertices, expected, 1e-4) << surface;
  }
}

TEST(Cover, MayBeAnyOtherMeshAndSaysWhichVerticesAreFar) {
  Overrides other{{"bodies.plate.cover.mesh", R"({"grid": {"size": [0.2, 0.1], "cells": [30, 17]}})"},
                  {"bodies.plate.cover.transform", R"({"translate": [0, 0, 0.01]})"}};
  auto model = build_model(read_scene(file("compressed_sheet"), other));
  EXPECT_EQ(model->bodies[1].vertices, 31 * 18);
  EXPECT_LE((model->equalities[0]->rows * model->positions).lpNorm<Eigen::Infinity>(), 1e-15);
  EXPECT_THAT(model->notes, IsEmpty());
  other.back().second = R"({"translate": [0, 0, 0.012]})";
  model = build_model(read_scene(file("compressed_sheet"), other));
  EXPECT_THAT(model->notes, Contains(HasSubstr("558 of its 558 vertices are farther than")));
}

TEST(Cover, RefusesMeshesThatCannotFollow) {
  EXPECT_THAT(
      refusal("compressed_sheet", {{"bodies.plate.cover.mesh", R"({"grid": {"size": [0.1, 0.1], "cells": [30, 17]}})"},
                                   {"bodies.plate.cover.transform", R"({"translate": [0, 0, 0.01]})"}}),
      HasSubstr("/bodies/plate/cover/mesh: plate/cover: none of its points is in a triangle of vertex 5 "));
}

TEST(Cover, IsAskedForByTheModelAndTheOtherWayRound) {
  EXPECT_THAT(refusal("compressed_sheet", {{"bodies.plate.model", "thick_shell"}}),
              HasSubstr("/bodies/plate/cover: found \"cover\", allowed: none of it unless"));
  EXPECT_THAT(refusal("stretched_sheet", {{"bodies.sheet.cover.surface", "top"}}),
              HasSubstr("/bodies/sheet/cover/surface: found \"top\" of sheet, which is cloth"));
}

TEST(Cover, TellsOfWrinklesThatWouldBeTooLong) {
  const auto model =
      build_model(read_scene(file("compressed_sheet"), {{"bodies.plate.cover.foundation.stiffness", "1e3"}}));
  // 2 pi (1.95e-5/1e3)^(1/4) = 0.0742 m against edges of 25 mm and diagonals of 35 mm.
  EXPECT_THAT(model->notes, Contains(HasSubstr("its wrinkles would be about 0.0742 m long")));
  EXPECT_THAT(model->notes, Contains(HasSubstr("edges of at least 0.0371 m")));
}

TEST(Cover, TellsOfPinsThatDecideTheCouplingAlone) {
  Overrides pins{{"bodies.sheet.cover.mesh.refine", "1"},
                 {"constraints.film_left", R"({"type": "pin", "body": "sheet/cover", "select": {"all": true}})"}};
  auto model = build_model(read_scene(file("stretched_sheet"), pins));
  // The film is held everywhere, the sheet at its ends, of which one moves: it cannot.
  EXPECT_THAT(model->notes, Contains(HasSubstr("pins decide 30 of its 165 equations")));
  EXPECT_THAT(model->notes, Contains(HasSubstr("contradict them by")));
  pins.emplace_back("constraints.right.motion.velocity", "[0, 0, 0]");
  model = build_model(read_scene(file("stretched_sheet"), pins));
  EXPECT_THAT(model->notes, testing::Not(Contains(HasSubstr("contradict"))));
}

TEST(Cover, HasTheSameImperfectionForTheSameSeed) {
  const auto positions = [](const std::string& seed) {
    return build_model(read_scene(file("quilt"), {{"bodies.quilt.cover.mesh.refine", "1"},
                                                  {"bodies.quilt.cover.imperfection.seed", seed}}))
        ->positions;
  };
  EXPECT_EQ(positions("3"), positions("3"));
  EXPECT_NE(positions("3"), positions("4"));
}

/// Least N H^2/B at which a strip of cells of length H buckles where the moments against the inner coarse hats are
/// zero, its ends simply supported.
double critical_load(int cells, int levels) {
  const TriangleMesh coarse = make_grid(cells, 0.05, cells, 1, Diagonals::right);
  const auto [fine, p] = refine(coarse, levels);
  const Index n = static_cast<Index>(fine.vertices.size());
  constexpr double d = 0.7, stretch = 0.9;
  const HingeBending bending("bending", make_hinges(fine.triangles, fine.vertices, d, true));
  const std::vector<RestTriangle> rest = rest_triangles(fine.triangles, fine.vertices);
  const Membrane membrane("membrane", rest, MembraneLaw::stvk, Lame::plane_stress(1, 0), 1);
  const auto vertical = [&](const Energy& energy, const Vector& x) {
    Assembly assembly(3 * n, {&energy}, {}, 1);
    assembly.hessian(x, Curvature::exact);
    const SparseMatrix whole = assembly.matrix().selfadjointView<Eigen::Lower>();
    Matrix z(n, n);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j < n; ++j) z(i, j) = whole.coeff(3 * i + 2, 3 * j + 2);
    }
    return z;
  };
  const Matrix stiffness = vertical(bending, flatten(fine.vertices));
  // The membrane's vertical Hessian under a uniaxial stress S is S grad w . grad w: here for S = 1.
  const Vector squeezed =
      flatten(mapped(fine.vertices, [](const Vector3& v) { return Vector3(stretch * v.x(), v.y(), 0); }));
  const Matrix geometric = -vertical(membrane, squeezed) / (0.5 * (1 - stretch * stretch));

  // The two coarse vertices across the strip together, whose hats make one of a beam.
  std::vector<Vector> rows;
  for (int k = 1; k < cells; ++k) rows.emplace_back(Vector(p.weights.col(k)) + Vector(p.weights.col(cells + 1 + k)));
  for (Index i = 0; i < n; ++i) {
    const double x = fine.vertices[static_cast<std::size_t>(i)].x();
    if (x < 1e-9 || x > cells - 1e-9) rows.emplace_back(Vector::Unit(n, i));
  }
  Matrix transposed(n, static_cast<Index>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) transposed.col(static_cast<Index>(k)) = rows[k];
  const Eigen::ColPivHouseholderQR<Matrix> qr(transposed);
  const Matrix z = Matrix(qr.householderQ()).rightCols(n - qr.rank());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> eigen(z.transpose() * geometric * z,
                                                               z.transpose() * stiffness * z);
  // On this grid, bent along it, hinges have three times the stiffness of a plate (docs/guide/energies.md).
  return 1 / (eigen.eigenvalues().maxCoeff() * 3 * d);
}

TEST(Coupling, LetsWrinklesOfTwiceTheCoarseEdgeAppearFirst) {
  // N H^2/B = pi^2 at wavelength 2 H: a beam with moments against hats, computed to 9.8696.
  const double pi2 = std::numbers::pi * std::numbers::pi;
  const double coarse = critical_load(4, 3), fine = critical_load(4, 4);
  EXPECT_NEAR(fine, pi2, 0.01 * pi2);
  EXPECT_LT(std::abs(fine - pi2), 0.5 * std::abs(coarse - pi2));
}

TEST(Foundation, GivesTheWavelengthOfItsLaw) {
  const Scene scene = read_scene(file("compressed_sheet"));
  const auto model = build_model(scene);
  Stepper stepper(*model, time_options(scene));
  const auto solver = build_solver(scene, 1);
  for (int step = 0; step < 4; ++step) {
    const Problem& problem = stepper.prepare();
    const Result result = solver->solve(problem, stepper.state().warm, {});
    ASSERT_EQ(result.status, Status::solved);
    stepper.accept(result);
  }
  std::vector<std::pair<double, double>> line;  // x and z along the middle of the film
  const BodyRange& film = model->bodies[1];
  for (int v = film.first_vertex; v < film.first_vertex + film.vertices; ++v) {
    if (std::abs(model->positions[3 * v + 1] - 0.05) < 1e-9)
      line.emplace_back(model->positions[3 * v], stepper.state().positions[3 * v + 2]);
  }
  std::sort(line.begin(), line.end());
  double mean = 0;
  for (const auto& [x, z] : line) mean += z / static_cast<double>(line.size());
  std::vector<double> crossings;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const double a = line[i].second - mean, b = line[i + 1].second - mean;
    if (a * b < 0 && line[i].first > 0.02 && line[i].first < 0.18)
      crossings.push_back(line[i].first + (line[i + 1].first - line[i].first) * a / (a - b));
  }
  ASSERT_GT(crossings.size(), 8u);
  const double found = 2 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  const double law = 2 * std::numbers::pi * std::pow(3 * 1.95e-5 / 5.7e5, 0.25);
  EXPECT_NEAR(found, law, 0.1 * law);
}

}  // namespace
}  // namespace taut
