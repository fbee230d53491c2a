#include "study/examine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "constraints/obstacle.h"
#include "problems/build.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

/// One equilateral triangle with its corners at distance `radius` from the origin, in the plane z = 0, and a unit ball
/// at the origin.
struct TriangleAroundBall {
  explicit TriangleAroundBall(double radius, std::vector<int> held = {0, 1, 2}) {
    model.triangles = {{0, 1, 2}};
    model.bodies = {{"sheet", 0, 3, 0, 1}};
    x.setZero(9);
    for (int i = 0; i < 3; ++i) {
      x[3 * i] = radius * std::cos(2 * M_PI * i / 3);
      x[3 * i + 1] = radius * std::sin(2 * M_PI * i / 3);
    }
    model.constraints.push_back(std::make_unique<SphereObstacle>("ball", "sheet", held, 0, 1.0, 1.0));
  }
  Model model;
  Vector x;
};

TEST(Penetrations, AreTheDepthOfEdgesAndFacesBelowTheSurface) {
  // An equilateral triangle's edges are half as far from its centre as its corners; the face goes through the centre.
  const TriangleAroundBall around(1.5);
  const auto found = penetrations(around.model, around.x);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].constraint, "ball");
  EXPECT_NEAR(found[0].edge, 0.25, 1e-14);
  EXPECT_NEAR(found[0].face, 1.0, 1e-14);
}

TEST(Penetrations, AreZeroWhereNothingIsInside) {
  TriangleAroundBall around(1.5);
  for (int i = 0; i < 3; ++i) around.x[3 * i + 2] = 1.0;
  const auto found = penetrations(around.model, around.x);
  EXPECT_EQ(found.at(0).edge, 0);
  EXPECT_NEAR(found.at(0).face, 0, 1e-14);
}

TEST(Penetrations, LookOnlyBetweenVerticesThatTheObstacleHolds) {
  const TriangleAroundBall around(1.5, {0, 1});
  const auto found = penetrations(around.model, around.x);
  EXPECT_NEAR(found.at(0).edge, 0.25, 1e-14);
  EXPECT_EQ(found.at(0).face, 0);
}

using ExamineTest = FilesTest;

TEST_F(ExamineTest, WorstElementsAreThoseFurthestOutside) {
  const Scene scene = tiny_scene(path("."));
  const auto model = build_model(scene);
  Stepper stepper(*model, time_options(scene));
  const Problem& problem = stepper.prepare();
  EXPECT_TRUE(worst_elements(problem, model->positions, 5).empty());
  Vector x = model->positions;
  x[0] -= 0.5;  // vertex 0 is a corner: 0.25 m cells
  const auto worst = worst_elements(problem, x, 2);
  ASSERT_EQ(worst.size(), 2u);
  EXPECT_EQ(worst[0].constraint, "limit");
  EXPECT_GE(worst[0].violation, worst[1].violation);
  EXPECT_NEAR(worst[0].violation, 3.0 - 1.02, 0.2);
  EXPECT_EQ(worst[0].element.substr(0, 9), "triangle ");
}

TEST_F(ExamineTest, VerticesAreNamedWithinTheirBody) {
  Model model;
  model.bodies = {{"upper", 0, 4, 0, 2}, {"lower", 4, 3, 2, 1}};
  EXPECT_EQ(vertex_name(model, 3), "vertex 3 of upper");
  EXPECT_EQ(vertex_name(model, 4), "vertex 0 of lower");
}

}  // namespace
}  // namespace taut
