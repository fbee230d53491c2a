#include "study/quantity_of_interest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "problems/read_scene.h"
#include "study/run.h"
#include "tests/files/temporary_folder.h"
#include "tests/study/tiny_scene.h"

namespace taut {
namespace {

using Kind = QuantityOfInterest::Kind;
using testing::HasSubstr;

TEST(QuantityOfInterest, IsReadAndWrittenAsOnTheCommandLine) {
  for (const char* text : {"probe:tip", "displacement", "shape", "frequency:3", "tension", "energy", "energy:kinetic"})
    EXPECT_EQ(parse_quantity(text).text(), text);
  EXPECT_EQ(parse_quantity("frequency").mode, 1);
  for (const char* text : {"", "probe", "probe:", "tip", "shape:x", "displacement:", "frequency:0", "frequency:one"})
    EXPECT_THROW(parse_quantity(text), InputError) << text;
}

TEST(QuantityOfInterest, TolerancesAreRelativeOrHaveAUnitOfTheQuantity) {
  const QuantityOfInterest shape = parse_quantity("shape"), probe = parse_quantity("probe:tip");
  EXPECT_DOUBLE_EQ(parse_tolerance("5%", shape).allowed(2), 0.1);
  EXPECT_DOUBLE_EQ(parse_tolerance("0.05", shape).allowed(2), 0.1);
  EXPECT_DOUBLE_EQ(parse_tolerance("2mm", shape).allowed(2), 0.002);
  EXPECT_DOUBLE_EQ(parse_tolerance("abs:0.002", probe).allowed(2), 0.002);
  EXPECT_DOUBLE_EQ(parse_tolerance("0.1Hz", parse_quantity("frequency:1")).allowed(2), 0.1);
  for (const char* text : {"", "%", "-1%", "0", "2J", "2 mm", "abs:2mm", "nan"})
    EXPECT_THROW(parse_tolerance(text, shape), InputError) << text;
  EXPECT_THROW(parse_tolerance("2mm", probe), InputError) << "the unit of a probe is not known";
}

class Answers : public FilesTest {
 protected:
  Answer answer(const std::string& quantity, const Scene& scene, const Scene& full, const std::string& name) const {
    RunOptions options;
    options.folder = path(name);
    options.threads = 1;
    run(scene, options);
    return Observer(parse_quantity(quantity), full)(read_stored_run(path(name))).value();
  }
};

TEST_F(Answers, OfOneSceneAreNoDistanceApartAndOfOtherMeshesASmallOne) {
  const Scene coarse = tiny_scene(path(""), {{"time.steps", "4"}});
  const Scene fine = tiny_scene(path(""), {{"time.steps", "4"}, {"bodies.cloth.mesh.grid.cells", "[8,8]"}});
  const Scene fall = tiny_scene(path(""), {{"time.steps", "1"}});
  const Answer own = answer("shape", fine, fine, "fine"), other = answer("shape", coarse, fine, "coarse"),
               far = answer("shape", fall, fine, "fall");
  EXPECT_EQ(own.values.size(), 3 * 81);
  EXPECT_EQ(distance(own, own), 0);
  EXPECT_LT(distance(own, other), 0.2 * own.magnitude);
  EXPECT_GT(distance(own, far), 0.5 * own.magnitude);
}

TEST_F(Answers, TheTensionOfAHangingStripIsItsWeight) {
  // rho t g over 1 m: 1.96 N/m at the top, in the middle of the last cell; the stretch of second Piola-Kirchhoff
  // tension is the strip's own, 1.05 where the limit holds it.
  const Scene strip = read_scene(std::string(TAUT_CATALOGUE) + "/stretched_strip.json", {{"output.pictures", "0"}});
  const Answer tension = answer("tension", strip, strip, "strip");
  const double cell = 1.0 / 40, weight = 200 * 0.001 * 9.81 * (1 - cell / 2);
  EXPECT_NEAR(tension.values[0], weight / 1.05, 0.02 * weight);
  EXPECT_NEAR(answer("displacement", strip, strip, "strip").values[0], 0.0433064, 0.01 * 0.0433064);
}

TEST_F(Answers, AQuantityThatTheSceneDoesNotHaveIsRefused) {
  const Scene scene = tiny_scene(path(""));
  for (const char* text : {"probe:tip", "frequency:1", "energy:bending of cloth"})
    EXPECT_THROW(Observer(parse_quantity(text), scene), InputError) << text;
  try {
    Observer(parse_quantity("energy:nothing"), scene);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("membrane of cloth"));
  }
}

}  // namespace
}  // namespace taut
