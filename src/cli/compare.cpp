#include "study/compare.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/progress.h"
#include "cli/report_option.h"
#include "cli/stop_signals.h"
#include "cli/temporary_folder.h"
#include "files/atomic_file.h"
#include "report/compare_report.h"
#include "report/compare_tables.h"
#include "report/suite_report.h"
#include "study/compare_job.h"
#include "study/compare_json.h"
#include "study/solver_entries.h"
#include "study/suite.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

struct CompareArguments {
  std::vector<std::string> problems, solvers, settings, variations;
  std::vector<double> tolerances;
  std::string suite, reference, out;
  int steps = 0, repeat = 1, threads = 1;
  double time_limit = 600, memory_limit = 8192;
  bool free = false, cold = false, resume = false, json = false, quiet = false;
  ReportOption report;
};

CompareOptions options_of(const CompareArguments& arguments) {
  CompareOptions options;
  for (const std::string& problem : arguments.problems) options.problems.push_back(find_problem(problem));
  options.choice.solvers = arguments.solvers;
  options.choice.reference = arguments.reference;
  options.choice.tolerances = arguments.tolerances;
  options.choice.settings = parse_settings(arguments.settings);
  for (const std::string& text : arguments.variations) options.choice.variations.push_back(parse_variation(text));
  options.steps = arguments.steps;
  options.repeat = arguments.repeat;
  options.threads = arguments.threads;
  options.free = arguments.free;
  options.cold = arguments.cold;
  options.resume = arguments.resume;
  options.time_limit = arguments.time_limit;
  options.memory_limit_bytes = static_cast<std::int64_t>(arguments.memory_limit * (1 << 20));
  options.worker = {"/proc/self/exe", "compare-worker"};
  options.version = TAUT_VERSION;
  return options;
}

std::string progress_note(const EntryRun& run) {
  const EntrySummary summary = summarize(run);
  return fmt::format("{}: {}/{} solved{}{}", run.label, summary.solved, run.steps_asked,
                     summary.false_successes > 0 ? fmt::format(", {} FALSE", summary.false_successes) : "",
                     run.outcome == "finished" ? "" : ", " + run.outcome);
}

int exit_code(const Comparison& comparison) {
  if (comparison.interrupted) return exit_interrupted;
  for (const ProblemComparison& problem : comparison.problems) {
    if (!problem.trajectory_solved) return exit_not_solved;
  }
  return exit_solved;
}

/// Models have no steps, no trajectory and no reference for it.
void check_suite(const CompareArguments& arguments) {
  if (!arguments.problems.empty() || !arguments.reference.empty() || arguments.steps > 0 || arguments.free ||
      arguments.cold || arguments.resume || arguments.threads != 1)
    throw UsageError("--suite takes no PROBLEM, --reference, --steps, --free, --cold, --resume and --threads");
  const fs::path out = arguments.out;
  std::error_code error;
  if (fs::exists(out, error) && !fs::is_empty(out, error) && !fs::exists(out / "compare.json", error))
    throw UsageError(arguments.out + ": is not empty and holds no comparison of taut; choose another directory");
}

int compare_on_suite(const CompareArguments& arguments) {
  check_suite(arguments);
  SuiteOptions options;
  options.folder = arguments.suite;
  options.choice.solvers = arguments.solvers;
  if (options.choice.solvers.empty()) options.choice.solvers = {"augmented_lagrangian", "ipopt", "nlopt"};
  options.choice.tolerances = arguments.tolerances;
  options.choice.settings = parse_settings(arguments.settings);
  for (const std::string& text : arguments.variations) options.choice.variations.push_back(parse_variation(text));
  options.repeat = arguments.repeat;
  options.time_limit = arguments.time_limit;
  options.memory_limit_bytes = static_cast<std::int64_t>(arguments.memory_limit * (1 << 20));
  options.worker = {"/proc/self/exe", "suite-worker"};
  options.version = TAUT_VERSION;
  options.stop = &stop_on_signals();
  const TemporaryFolder logs;
  options.logs = logs.path();

  TaskProgress progress("compare", arguments.quiet);
  options.on_start = [&](int processes) { progress.begin(processes); };
  options.on_run = [&](const SuiteModel& model, const SuiteEntry& entry, const SuiteRun& run) {
    progress.done(fmt::format("{}, {}: {}", model.name, entry.chosen.label,
                              run.outcome == "finished" ? to_string(run.status) : run.outcome));
  };
  const Suite suite = run_suite(options);
  progress.end(suite.interrupted);
  if (!arguments.out.empty()) {
    std::error_code error;
    fs::create_directories(arguments.out, error);
    write_atomically(fs::path(arguments.out) / "compare.json", suite_text(suite));
    write_atomically(fs::path(arguments.out) / "compare.md", suite_markdown(suite));
    write_atomically(fs::path(arguments.out) / "compare.csv", suite_csv(suite));
  }
  const std::string text = arguments.json    ? suite_text(suite)
                           : arguments.quiet ? ""
                                             : suite_terminal(suite, arguments.out);
  const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (arguments.report.wanted()) arguments.report.write(suite_report(suite, typed_command()), arguments.quiet);
  if (!printed) return exit_internal_error;
  return suite.interrupted ? exit_interrupted : exit_solved;
}

int compare_solvers(const CompareArguments& arguments) {
  arguments.report.check();
  if (!arguments.suite.empty()) return compare_on_suite(arguments);
  if (arguments.problems.empty() || arguments.solvers.empty())
    throw UsageError("compare needs a PROBLEM and --solvers, or --suite DIR; see taut compare --help");
  const OutFolder folder(arguments.out, arguments.resume, "comparison");
  CompareOptions options = options_of(arguments);
  options.stop = &stop_on_signals();
  options.folder = folder.path();
  TaskProgress progress("compare", arguments.quiet);
  options.on_start = [&](int processes) { progress.begin(processes); };
  options.on_run = [&](const EntryRun& run) { progress.done(progress_note(run)); };
  const Comparison comparison = compare(options);
  progress.end(comparison.interrupted);

  write_atomically(options.folder / "compare.md", compare_markdown(comparison));
  write_atomically(options.folder / "compare.csv", compare_csv(comparison));

  const std::string text = arguments.json    ? comparison_text(comparison)
                           : arguments.quiet ? ""
                                             : compare_terminal(comparison, arguments.out);
  const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (arguments.report.wanted())
    arguments.report.write(compare_report(comparison, typed_command(), options.folder), arguments.quiet);
  return printed ? exit_code(comparison) : exit_internal_error;
}

std::string footer() {
  std::string text = "\nSolvers:\n";
  for (const SolverEntry& entry : solver_entries())
    text += fmt::format("  {:<22} {}\n", entry.label, entry.description);
  return text +
         "\nWhat happens: the reference solves the steps; every entry then solves each of them from the state that "
         "the\n"
         "reference had before it (--free: from its own), in a process of its own with a limit on time and memory.\n"
         "The first step is solved once more before any time is taken. Residuals computed from problem and result\n"
         "alone decide what is solved; a solver that says solved where they do not is counted as a false success.\n"
         "A crash or a limit ends one process, never the comparison.\n"
         "\n"
         "Files in DIR: compare.json (everything), compare.md, compare.csv (a line per entry and step), and a "
         "directory\n"
         "per problem with the states and, per entry, its log, steps.jsonl and solutions.\n"
         "--report DIR writes DIR/index.html: the mesh in 3D, charts, a map of what became of each step, how to repeat "
         "each\n"
         "entry.\n"
         "\n"
         "Exit codes: 0 the comparison is complete, whatever its result; 1 internal error; 2 wrong usage or input;\n"
         "3 complete, but the reference did not solve every step; 130 interrupted, finished processes are kept.\n"
         "\n"
         "Examples:\n"
         "  taut compare hanging_cloth --solvers augmented_lagrangian,multiplier_loop --steps 10\n"
         "  taut compare hanging_cloth --solvers augmented_lagrangian --vary "
         "constraints.limit.form=matrix,singular_values\n"
         "  taut compare a.json b.json --solvers augmented_lagrangian --tolerances 1e-6,1e-8 --repeat 5 --out out/ab\n"
         "  taut compare --suite problems/nl --vary solver.starts=1,8 --time-limit 20 --report out/suite";
}

void add_choice(CLI::App& command, CompareArguments& arguments) {
  const auto list = CLI::MultiOptionPolicy::TakeAll;
  command.add_option("PROBLEM", arguments.problems, "Problem files, or names of problems of the catalogue");
  command
      .add_option("--suite", arguments.suite,
                  "Instead of problems a folder of AMPL models (.nl); without --solvers: ours, ipopt and nlopt")
      ->type_name("DIR");
  command.add_option("--solvers", arguments.solvers, "Which solvers, separated by commas")
      ->type_name("A,B,...")
      ->expected(1)
      ->delimiter(',')
      ->multi_option_policy(list);
  command.add_option("--reference", arguments.reference, "Solver whose trajectory gives the states; none: the first")
      ->type_name("A");
  command
      .add_option("--vary", arguments.variations,
                  "Every solver with each of these values of a key of the problem; repeated: every combination")
      ->type_name("KEY=V1,V2")
      ->expected(1)
      ->multi_option_policy(list);
  command
      .add_option("--tolerances", arguments.tolerances,
                  "Every entry at each of these tolerances; none: the problem's own")
      ->type_name("T1,T2")
      ->expected(1)
      ->delimiter(',')
      ->multi_option_policy(list)
      ->check(CLI::PositiveNumber);
  command
      .add_option("--set", arguments.settings,
                  "Replace a value of the problem for every entry, with a dotted key; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(list);
  command.add_option("--steps", arguments.steps, "The first N steps only")
      ->type_name("N")
      ->check(CLI::Range(1, 1000000000));
  command.add_flag("--free", arguments.free, "Let every entry follow its own trajectory");
  command.add_flag("--cold", arguments.cold, "Start every step without multipliers");
}

}  // namespace

void add_compare(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("compare", "Compare solvers on the same steps, each judged alike");
  command->footer(footer());
  const auto arguments = std::make_shared<CompareArguments>();
  add_choice(*command, *arguments);
  command->add_option("--repeat", arguments->repeat, "Solve and time each step K times (default 1)")
      ->type_name("K")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--threads", arguments->threads, "Threads of each solver (default 1); 0: the machine's cores")
      ->type_name("N")
      ->check(CLI::Range(0, 255));
  command->add_option("--time-limit", arguments->time_limit, "Seconds for each process (default 600); 0: no limit")
      ->type_name("S")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--memory-limit", arguments->memory_limit, "MB for each process (default 8192); 0: no limit")
      ->type_name("MB")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out", arguments->out, "Write everything to this directory")->type_name("DIR");
  command->add_flag("--resume", arguments->resume, "Take over what is finished in DIR");
  add_report_option(*command, arguments->report);
  command->add_flag("--json", arguments->json, "Print compare.json on standard output, and nothing else there");
  command->add_flag("--quiet", arguments->quiet, "No progress and no tables: errors only");
  command->callback([arguments, &code] { code = compare_solvers(*arguments); });
}

void add_compare_worker(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("compare-worker", "One process of taut compare")->group("");
  const auto job = std::make_shared<std::string>();
  command->add_option("JOB", *job, "Its job file")->required();
  command->callback([job, &code] { code = work(*job); });
}

void add_suite_worker(CLI::App& program) {
  struct Arguments {
    std::string model;
    std::vector<std::string> settings;
    int repeat = 1;
    double max_seconds = 0;
  };
  CLI::App* command = program.add_subcommand("suite-worker", "One process of taut compare --suite")->group("");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("MODEL", arguments->model)->required();
  command->add_option("--set", arguments->settings)->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("--repeat", arguments->repeat);
  command->add_option("--max-seconds", arguments->max_seconds);
  command->callback([arguments] {
    try_model(arguments->model, parse_settings(arguments->settings), arguments->repeat, arguments->max_seconds);
  });
}

}  // namespace taut
