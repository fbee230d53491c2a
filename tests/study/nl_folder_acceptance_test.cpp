// A folder of models, for which TAUT_NL_DIR stands: ours against the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "study/suite.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

class NlFolder : public FilesTest {};

TEST_F(NlFolder, OursIsNeverWrongAndNoSlowerThanIpopt) {
  const char* folder = std::getenv("TAUT_NL_DIR");
  if (!folder) GTEST_SKIP() << "TAUT_NL_DIR is not set";
  SuiteOptions options;
  options.folder = folder;
  options.choice.solvers = {"augmented_lagrangian", "nlopt"};
#ifdef TAUT_WITH_IPOPT
  options.choice.solvers.push_back("ipopt");
#endif
  options.worker = {TAUT_PROGRAM, "suite-worker"};
  options.logs = path(".");
  const Suite suite = run_suite(options);
  const SuiteScore ours = score_of(suite, suite.entries[0]);
  for (std::size_t k = 0; k < suite.models.size(); ++k) {
    const SuiteRun& run = suite.entries[0].runs[k];
    EXPECT_THAT(run.outcome, testing::AnyOf("finished", "refused")) << suite.models[k].name << ": " << run.message;
    EXPECT_FALSE(run.false_success) << suite.models[k].name;
  }
  for (std::size_t k = 1; k < suite.entries.size(); ++k) {
    const SuiteScore other = score_of(suite, suite.entries[k]);
    EXPECT_GE(ours.correct, other.correct) << suite.entries[k].chosen.label;
    if (suite.entries[k].chosen.solver == "ipopt") {
      EXPECT_LE(ours.median_seconds, other.median_seconds);
    }
  }
}

}  // namespace
}  // namespace taut
