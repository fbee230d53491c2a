#include "cli/model.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "cli/commands.h"
#include "cli/stop_signals.h"
#include "problems/nl_model.h"
#include "report/model_report.h"
#include "report/model_summary.h"
#include "study/records_json.h"
#include "study/solve_model.h"

namespace taut {
namespace {

Budget budget_of(double max_seconds) {
  Budget budget;
  budget.stop = &stop_on_signals();
  if (max_seconds > 0)
    budget.deadline =
        std::chrono::steady_clock::now() +
        std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(max_seconds));
  return budget;
}

int exit_code(Status status) {
  if (status == Status::solved) return exit_solved;
  return status == Status::interrupted ? exit_interrupted : exit_not_solved;
}

/// AMPL's solve_result_num: 0 solved, 200 infeasible, 300 unbounded, 400 a limit, 500 failure.
int solve_result(Status status) {
  switch (status) {
    case Status::solved:
      return 0;
    case Status::infeasible:
      return 200;
    case Status::unbounded:
      return 300;
    case Status::iteration_limit:
      return 400;
    case Status::time_limit:
      return 401;
    case Status::interrupted:
      return 402;
    case Status::stalled:
      return 500;
    case Status::not_finite:
      return 501;
    case Status::limit_point:
      return 502;
  }
  return 500;
}

/// One word of taut_options or of the command line.
void read_option(const std::string& word, ModelArguments& arguments) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError("option \"" + word + "\": expected KEY=VALUE, as in tolerance.feasibility=1e-9 or max_seconds=60");
  const std::string key = word.substr(0, equals), value = word.substr(equals + 1);
  if (key != "max_seconds") {
    arguments.settings.emplace_back("solver." + key, value);
    return;
  }
  char* end = nullptr;
  arguments.max_seconds = std::strtod(value.c_str(), &end);
  if (*end != '\0' || !(arguments.max_seconds > 0))
    throw UsageError("max_seconds: expected a number above 0, got " + value);
}

bool ends_in_nl(std::string_view text) { return text.size() > 3 && text.substr(text.size() - 3) == ".nl"; }

}  // namespace

int solve_model_file(const ModelArguments& arguments) {
  const Budget budget = budget_of(arguments.max_seconds);
  const Scene settings = read_model_settings(arguments.file, arguments.settings);
  const NlModel model(arguments.file);
  ModelSolution solution = solve_model(model, settings, budget, TAUT_VERSION);
  if (!arguments.out.empty()) write_model_solution(arguments.out, model, solution);
  const std::string text = arguments.json    ? summary_text(solution.summary)
                           : arguments.quiet ? ""
                                             : model_summary(solution, arguments.out);
  const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (arguments.report.wanted())
    arguments.report.write(model_report(model, solution, settings, typed_command()), arguments.quiet);
  return printed ? exit_code(solution.summary.status) : exit_internal_error;
}

bool is_ampl_call(int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return false;
  return ends_in_nl(argv[1]) || (argc > 2 && std::string_view(argv[2]) == "-AMPL");
}

int run_as_ampl_solver(int argc, char** argv) {
  ModelArguments arguments;
  arguments.file = argv[1];
  if (!ends_in_nl(arguments.file)) arguments.file += ".nl";
  if (const char* options = std::getenv("taut_options")) {
    std::istringstream words(options);
    for (std::string word; words >> word;) read_option(word, arguments);
  }
  for (int i = 2; i < argc; ++i) {
    if (std::string_view(argv[i]) != "-AMPL") read_option(argv[i], arguments);
  }
  const Budget budget = budget_of(arguments.max_seconds);
  const Scene settings = read_model_settings(arguments.file, arguments.settings);
  const NlModel model(arguments.file);
  const ModelSolution solution = solve_model(model, settings, budget, TAUT_VERSION);
  const RunSummary& summary = solution.summary;
  const std::string message = fmt::format(
      "Taut " TAUT_VERSION ": {}; objective {:.10g}; stationarity {:.1e}, violation {:.1e}, {} linear systems",
      to_string(summary.status), summary.objective, summary.stationarity.scaled, summary.feasibility.unscaled,
      summary.counts.linear_solves);
  model.write_solution(message, solve_result(summary.status), solution.x, solution.dual);
  return exit_solved;
}

}  // namespace taut
