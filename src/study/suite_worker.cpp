#include <chrono>
#include <cstdio>

#include "study/compare_records.h"
#include "study/solve_model.h"
#include "study/suite.h"
#include "study/suite_json.h"

namespace taut {

void try_model(const std::string& file, const Overrides& overrides, int repeat, double max_seconds) {
  using Clock = std::chrono::steady_clock;
  Budget budget;
  if (max_seconds > 0)
    budget.deadline =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(max_seconds));
  const Scene settings = read_model_settings(file, overrides);
  const NlModel model(file);
  SuiteRun run;
  std::vector<double> seconds;
  for (int k = 0; k == 0 || (k < repeat && !budget.out_of_time()); ++k) {
    const ModelSolution solution = solve_model(model, settings, budget, "");
    const RunSummary& summary = solution.summary;
    run.outcome = "finished";
    run.status = summary.status;
    run.message = summary.message;
    run.false_success = solution.false_success;
    run.maximise = model.maximise();
    run.objective = summary.objective;
    run.violation = summary.feasibility.unscaled;
    run.stationarity = summary.stationarity.scaled;
    run.counts = summary.counts;
    seconds.push_back(summary.seconds.solver.total);
  }
  run.seconds = spread_of(seconds).median;
  std::printf("%s\n", suite_run_line(run).c_str());
}

}  // namespace taut
