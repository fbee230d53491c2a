#include "study/lean_ladder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "files/atomic_file.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

class Ladder : public FilesTest {
 protected:
  static Scene scene(const std::string& name, const Overrides& overrides = {}) {
    return read_scene(std::string(TAUT_CATALOGUE) + "/" + name + ".json", overrides);
  }
  static std::vector<std::string> names(const LeanLadder& ladder) {
    std::vector<std::string> result;
    for (const Simplification& one : ladder.simplifications) result.push_back(one.name);
    return result;
  }
  /// The problem with one simplification at a level.
  Scene with(const Scene& full, const std::string& name, int level) const {
    const LeanLadder ladder = lean_ladder(full);
    Levels levels;
    for (const Simplification& one : ladder.simplifications) levels.push_back(one.name == name ? level : 0);
    write_rung(full, ladder, levels, "rung", path("rung.json"));
    return read_scene(path("rung.json"));
  }
};

TEST_F(Ladder, OfAClothHasMeshStepToleranceBendingLimitAndIntegrator) {
  const LeanLadder ladder = lean_ladder(scene("trampoline"));
  EXPECT_THAT(names(ladder),
              ElementsAre("mesh", "step", "tolerance", "bending of mat", "strain limit limit", "integrator"));
  EXPECT_THAT(ladder.simplifications[0].levels, ElementsAre("24 x 24 cells", "12 x 12 cells", "6 x 6 cells"));
  EXPECT_THAT(ladder.not_applicable, Contains(Field(&NotApplicable::name, "modal body")));
}

TEST_F(Ladder, EveryRungOfEveryKindOfSceneIsAProblemThatReads) {
  for (const char* name : {"trampoline", "quilt", "flag", "modal_cantilever", "stretched_strip", "validation/cook",
                           "validation/plate_simply_supported_5_layers", "validation/pagano_4_3"}) {
    const Scene full = scene(name);
    const LeanLadder ladder = lean_ladder(full);
    for (std::size_t k = 0; k < ladder.simplifications.size(); ++k) {
      for (int level = 1; level <= ladder.simplifications[k].simplest(); ++level) {
        Levels levels(ladder.simplifications.size(), 0);
        levels[k] = level;
        EXPECT_NO_THROW(write_rung(full, ladder, levels, "rung", path("rung.json")))
            << name << ": " << words_of(ladder, levels);
        EXPECT_NE(read_scene(path("rung.json")).hash, full.hash) << name << ": " << words_of(ladder, levels);
      }
    }
  }
}

TEST_F(Ladder, LongerStepsEndAtTheSameTime) {
  const Scene full = scene("trampoline"), rung = with(full, "step", 3);
  EXPECT_EQ(rung.time.steps, 13);
  EXPECT_NEAR(rung.time.step * rung.time.steps, full.time.step * full.time.steps, 1e-12);
}

TEST_F(Ladder, PointLoadsOnARegionKeepTheirSum) {
  const Scene full = scene("trampoline");
  for (const int level : {1, 2}) {
    const Scene rung = with(full, "mesh", level);
    double sums[2];
    for (const Scene* one : {&full, &rung}) {
      const auto model = build_model(*one);
      double sum = 0;
      for (const auto& load : model->dead_loads)
        if (load->name() != "gravity") sum += load->forces().sum();
      sums[one == &rung] = sum;
    }
    EXPECT_LT(sums[0], -1);
    EXPECT_NEAR(sums[1], sums[0], 1e-9 * std::abs(sums[0])) << level;
  }
}

TEST_F(Ladder, MeshesFromFilesAreSkippedWithTheReason) {
  const LeanLadder ladder = lean_ladder(scene("validation/cook"));
  EXPECT_THAT(ladder.not_applicable, Contains(Field(&NotApplicable::reason, HasSubstr("is from a file"))));
}

TEST_F(Ladder, AThickShellBecomesASheetWithItsBendingStiffnessOrAMembrane) {
  const Scene full = scene("validation/plate_clamped_10"), rung = with(full, "thick shell shell", 1);
  ASSERT_TRUE(rung.bodies[0].bending);
  EXPECT_NEAR(rung.bodies[0].bending->stiffness, 1e9 * 1e-3 / (12 * (1 - 0.09)), 1e-6);
  EXPECT_FALSE(rung.bodies[0].shell);
  const Scene membrane = with(full, "thick shell shell", 2);
  EXPECT_TRUE(membrane.bodies[0].membrane);
  EXPECT_FALSE(membrane.bodies[0].bending);
}

TEST_F(Ladder, ACoverOfRatio16GoesDownThrough8And4And2) {
  const LeanLadder ladder = lean_ladder(scene("quilt", {{"bodies.quilt.cover.mesh.refine", "4"}}));
  const auto cover = std::find_if(ladder.simplifications.begin(), ladder.simplifications.end(),
                                  [](const Simplification& one) { return one.name == "cover of quilt"; });
  ASSERT_NE(cover, ladder.simplifications.end());
  EXPECT_THAT(cover->levels, ElementsAre("as written", "cover of quilt at ratio 8", "cover of quilt at ratio 4",
                                         "cover of quilt at ratio 2", "quilt without its cover"));
}

TEST_F(Ladder, ResidualsMayTellOfMeshesAndTolerancesOfStaticProblemsOnly) {
  for (const auto& [name, may] : {std::pair{"stretched_strip", true}, std::pair{"trampoline", false}})
    for (const Simplification& one : lean_ladder(scene(name)).simplifications)
      EXPECT_EQ(one.has_residual, may && (one.name == "mesh" || one.name == "tolerance")) << name << ": " << one.name;
}

TEST_F(Ladder, MergedLayersKeepMassAndStretchingStiffness) {
  const Scene full = scene("quilt"), rung = with(full, "layers of quilt", 1);
  const std::vector<scene::Layer>&before = full.bodies[0].shell->layers, &after = rung.bodies[0].shell->layers;
  ASSERT_EQ(after.size(), 1u);
  const auto mass = [](double sum, const scene::Layer& layer) { return sum + layer.thickness * layer.density; };
  EXPECT_NEAR(mass(0, after[0]), std::accumulate(before.begin(), before.end(), 0.0, mass), 1e-12);
  EXPECT_NEAR(after[0].thickness, 0.03, 1e-12);
}

TEST_F(Ladder, ACoverGoesWithItsConstraints) {
  const Scene rung = with(scene("quilt"), "cover of quilt", 3);
  EXPECT_EQ(rung.bodies.size(), 1u);
  for (const scene::Constraint& constraint : rung.constraints) EXPECT_NE(constraint.name, "limit");
}

TEST_F(Ladder, WhatACheckTriesToRemoveIncludesLoadsAndObstacles) {
  EXPECT_THAT(names(omissions_of(scene("table_cloth"))),
              testing::IsSupersetOf(
                  {"tolerance", "step", "bending of cloth", "strain limit limit", "obstacle ball", "gravity"}));
  EXPECT_THAT(names(omissions_of(scene("flag"))), Contains("load wind"));
}

}  // namespace
}  // namespace taut
