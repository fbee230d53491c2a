// Ten scenes whose full answer is known by solving them: the promise of `taut lean`.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "study/child_process.h"
#include "study/lean.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using Json = nlohmann::json;

/// CPU seconds of this process and of all that it has waited for, which other work on the machine changes little.
double cpu_seconds() {
  double sum = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    for (const timeval& time : {usage.ru_utime, usage.ru_stime})
      sum += static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  }
  return sum;
}

class LeanOnTenScenes : public FilesTest {};

TEST_F(LeanOnTenScenes, IsRightOnAllAndCheaperThanTheFullSceneOnSeven) {
  const Json scenes = Json::parse(std::ifstream(std::string(TAUT_SOURCE_DIR) + "/tests/study/lean_scenes.json"));
  ASSERT_EQ(scenes.size(), 10u);
  std::map<std::string, int> cheaper;
  for (const auto& [name, scene] : scenes.items()) {
    const std::filesystem::path problem =
        std::string(TAUT_CATALOGUE) + "/" + scene["problem"].get<std::string>() + ".json";
    Overrides settings;
    std::vector<std::string> command{TAUT_PROGRAM, "solve", problem.string(), "--threads",        "1",
                                     "--format",   "none",  "--out",          path(name).string()};
    for (const std::string setting : scene["set"]) {
      const std::size_t equals = setting.find('=');
      settings.emplace_back(setting.substr(0, equals), setting.substr(equals + 1));
      command.insert(command.end(), {"--set", setting});
    }
    double before = cpu_seconds();
    ASSERT_EQ(run_child(command, path(name + ".log"), {}).code, 0) << name;
    const double full = cpu_seconds() - before;
    for (const char* tolerance : {"5%", "1%"}) {
      LeanOptions options;
      options.problem = problem;
      options.settings = settings;
      options.quantity = parse_quantity(scene["quantity"]);
      options.tolerance = parse_tolerance(tolerance, options.quantity);
      options.known = path(name);
      options.folder = path(name + "_lean_" + tolerance);
      options.program = {TAUT_PROGRAM};
      before = cpu_seconds();
      const LeanStudy study = lean(options);
      const double search = cpu_seconds() - before;
      ASSERT_TRUE(study.outcome.lean) << name;
      const LeanRung& rung = study.outcome.rungs[*study.outcome.lean];
      EXPECT_LE(rung.true_error.value(), options.tolerance.value * study.outcome.magnitude)
          << name << " at " << tolerance;
      EXPECT_TRUE(study.outcome.end == LeanEnd::verified || study.outcome.end == LeanEnd::exact) << name;
      if (search < full) ++cheaper[tolerance];
      std::printf("%-22s %-3s %7.2f s of %7.2f s, true error %.2g: %s\n", name.c_str(), tolerance, search, full,
                  *rung.true_error / study.outcome.magnitude, rung.words.c_str());
    }
  }
  EXPECT_GE(cheaper["5%"], 7);
  EXPECT_GE(cheaper["1%"], 7);
}

}  // namespace
}  // namespace taut
