#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/model.h"
#include "cli/progress.h"
#include "cli/report_option.h"
#include "cli/stop_signals.h"
#include "problems/read_scene.h"
#include "report/run_report.h"
#include "report/terminal_summary.h"
#include "study/records_json.h"
#include "study/run.h"

namespace taut {
namespace {

struct SolveArguments {
  std::string problem, out, format, accelerations;
  std::vector<std::string> settings;
  int threads = 0, history = 0;
  std::pair<int, std::string> exported;  // step and file
  double max_seconds = 0;
  long max_linear_solves = 0;
  bool resume = false, json = false, quiet = false;
  ReportOption report;
};

Overrides overrides_of(const SolveArguments& arguments) {
  Overrides overrides = parse_settings(arguments.settings);
  if (!arguments.format.empty()) overrides.emplace_back("output.format", arguments.format);
  return overrides;
}

std::string progress_note(const StepRecord& record) {
  if (record.status != Status::solved) return fmt::format("step {}: {}", record.step, to_string(record.status));
  return fmt::format("{} Newton systems, residual {:.0e}", record.counts.linear_solves, record.residuals.stationarity);
}

int exit_code(Status status) {
  if (status == Status::solved) return exit_solved;
  return status == Status::interrupted ? exit_interrupted : exit_not_solved;
}

/// Where the run is written: a report without --out keeps its run beside it.
std::string run_folder(const SolveArguments& arguments) {
  if (!arguments.out.empty() || !arguments.report.wanted()) return arguments.out;
  return (std::filesystem::path(arguments.report.folder) / "run").string();
}

/// A model has no steps to resume, no frames and no modes.
int solve_model(const SolveArguments& arguments) {
  if (arguments.resume || arguments.history > 0 || !arguments.accelerations.empty() || !arguments.format.empty() ||
      arguments.exported.first > 0 || arguments.max_linear_solves > 0)
    throw UsageError(
        "--resume, --history, --export-step, --max-linear-solves, --format and --record-accelerations are for "
        "scenes; " +
        arguments.problem + " is an optimisation model");
  return solve_model_file({arguments.problem, arguments.out, parse_settings(arguments.settings), arguments.max_seconds,
                           arguments.json, arguments.quiet, arguments.report});
}

int solve(const SolveArguments& arguments) {
  arguments.report.check();
  if (arguments.resume && arguments.out.empty())
    throw UsageError("--resume needs --out DIR, the directory of the run to go on with");
  if (arguments.resume && !arguments.accelerations.empty())
    throw UsageError("--record-accelerations needs a run from its beginning, without --resume");
  if (arguments.resume && arguments.exported.first > 0)
    throw UsageError("--export-step needs a run from its beginning, without --resume");
  if (std::filesystem::path(arguments.problem).extension() == ".nl") return solve_model(arguments);
  if (arguments.history > 0 && arguments.out.empty())
    throw UsageError("--history needs --out DIR, which it is written to");
  const std::atomic<bool>& stop_requested = stop_on_signals();
  const Scene scene = read_scene(find_problem(arguments.problem), overrides_of(arguments));
  if (arguments.history > scene.time.steps)
    throw UsageError(fmt::format("--history {}: {} has {} steps", arguments.history, scene.name, scene.time.steps));
  if (arguments.exported.first > scene.time.steps)
    throw UsageError(
        fmt::format("--export-step {}: {} has {} steps", arguments.exported.first, scene.name, scene.time.steps));

  std::unique_ptr<Progress> progress;
  RunOptions options;
  options.folder = run_folder(arguments);
  options.resume = arguments.resume;
  options.accelerations = arguments.accelerations;
  options.threads = arguments.threads;
  options.max_seconds = arguments.max_seconds;
  options.max_linear_solves = arguments.max_linear_solves;
  options.history_step = arguments.history;
  options.export_step = arguments.exported.first;
  options.export_file = arguments.exported.second;
  options.stop = &stop_requested;
  options.version = TAUT_VERSION;
  int last_step = 0;  // begun and judged
  if (!arguments.quiet) {
    options.on_start = [&](int done) {
      progress = std::make_unique<Progress>(scene.name, scene.time.steps, stderr, done);
    };
    options.on_step = [&](const StepRecord& record) {
      if (record.status != Status::solved) {
        progress->clear();
        fmt::print(stderr, "step {}: {}: {}\n", record.step, to_string(record.status), record.message);
      }
      progress->update(record.step, progress_note(record));
      last_step = record.step;
    };
  }
  const RunSummary summary = run(scene, options);
  if (progress) progress->finish();
  if (const auto& [step, file] = arguments.exported; step > 0 && !arguments.quiet) {
    const char* what = last_step >= step ? "its model is in" : "not reached, and so there is no model in";
    fmt::print(stderr, "step {}: {} {}\n", step, what, file);
  }

  const std::string text = arguments.json    ? summary_text(summary)
                           : arguments.quiet ? ""
                                             : terminal_summary(summary, options.folder.string());
  const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (arguments.report.wanted()) arguments.report.write(run_report(options.folder, typed_command()), arguments.quiet);
  return printed ? exit_code(summary.status) : exit_internal_error;
}

constexpr const char* footer =
    "\nWhat happens: every time step is posed as one constrained minimisation and solved; then residuals that\n"
    "are computed from the problem and the result alone (stationarity, feasibility, complementarity) decide\n"
    "whether the step counts as solved. A run stops at the first step that is not, unless the problem says\n"
    "solver.on_failure = continue; what it reached is written either way.\n"
    "\n"
    "Files in DIR: summary.json (the verdict), steps.jsonl (a line a step), frames/ and NAME.pvd (ParaView),\n"
    "pictures/ (SVG), problem.json (the completed problem, which runs again), checkpoint.bin (for --resume).\n"
    "An earlier run in DIR is replaced; a directory with anything else in it is refused.\n"
    "--report DIR writes DIR/index.html, with charts and the result in three dimensions, from the files of --out;\n"
    "without --out those are in DIR/run.\n"
    "\n"
    "Ctrl-C (or SIGTERM) ends the run after the current linear solve and keeps every finished step; twice, at once.\n"
    "\n"
    "Exit codes: 0 every step solved, 1 internal error, 2 wrong usage or input, 3 not every step solved or time over,\n"
    "130 interrupted.\n"
    "\n"
    "Examples:\n"
    "  taut solve hanging_cloth --out out/cloth\n"
    "  taut solve problem.json --out out/short --set time.steps=10 --set constraints.limit.max=1.05\n"
    "  taut solve problem.json --out out/long --max-seconds 3600     and later, the same with --resume\n"
    "  taut solve hanging_cloth --report out/report\n"
    "  taut solve problem.json --json | jq .status\n"
    "  taut solve hanging_cloth --set time.steps=5 --export-step 5 out/step.nl\n"
    "  taut solve model.nl --set solver.tolerance.feasibility=1e-9 --out out/model\n"
    "                                            an optimisation model of AMPL, Pyomo or JuMP";

}  // namespace

void add_solve(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("solve", "Solve a problem and judge every step");
  command->footer(footer);
  const auto arguments = std::make_shared<SolveArguments>();
  command
      ->add_option("PROBLEM", arguments->problem,
                   "A problem file, the name of one in the catalogue, or an AMPL model (.nl)")
      ->required();
  command->add_option("--out", arguments->out, "Write results to this directory; without it nothing is written")
      ->type_name("DIR");
  command
      ->add_option("--set", arguments->settings,
                   "Replace a value of the problem for this run, with a dotted key; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      ->add_option("--threads", arguments->threads,
                   "Threads; 0 or none: the machine's cores, with --resume those of the run")
      ->type_name("N")
      ->check(CLI::Range(0, 255));
  command
      ->add_option("--max-seconds", arguments->max_seconds, "Stop after this time with what is finished (exit code 3)")
      ->type_name("S")
      ->check(CLI::Validator(
          [](const std::string& text) {
            return std::strtod(text.c_str(), nullptr) > 0 ? "" : "expected a number above 0, got " + text;
          },
          "> 0"));
  command
      ->add_option("--max-linear-solves", arguments->max_linear_solves,
                   "Stop after so many Newton systems, which are the same on every machine (exit code 3)")
      ->type_name("N")
      ->check(CLI::Range(1L, 1000000000L));
  command->add_option("--format", arguments->format, "Format of the frames: vtu, obj or none; replaces output.format")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"vtu", "obj", "none"}));
  command
      ->add_option("--record-accelerations", arguments->accelerations,
                   "Write the spectral accelerations of a modal body to this file (taut replay)")
      ->type_name("FILE");
  command
      ->add_option("--history", arguments->history,
                   "Judge every iterate of this step and write them to DIR/history.csv (taut chart)")
      ->type_name("STEP")
      ->check(CLI::Range(1, 1000000000));
  command
      ->add_option("--export-step", arguments->exported,
                   "Write this step as an AMPL model (.nl) for other solvers, before it is solved")
      ->type_name("STEP FILE")
      ->check(CLI::Validator(
          [](const std::string& text) {
            const bool file = std::filesystem::path(text).extension() == ".nl";
            return file || std::atoi(text.c_str()) > 0 ? ""
                                                       : "expected a step from 1 on and a file FILE.nl, got " + text;
          },
          ""));
  command->add_flag("--resume", arguments->resume,
                    "Go on with the run in DIR; ends with the bits of one never interrupted");
  add_report_option(*command, arguments->report);
  command->add_flag("--json", arguments->json, "Print summary.json on standard output, and nothing else there");
  command->add_flag("--quiet", arguments->quiet, "No progress and no summary: errors only");
  command->callback([arguments, &code] { code = solve(*arguments); });
}

}  // namespace taut
