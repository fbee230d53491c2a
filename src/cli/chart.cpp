#include "study/chart.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
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
#include "report/chart_report.h"
#include "report/chart_tables.h"
#include "report/html_report.h"
#include "study/chart_json.h"
#include "study/solver_entries.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

struct ChartArguments {
  std::vector<std::string> problems, solvers{"augmented_lagrangian", "multiplier_loop", "ipopt"}, settings;
  std::string knob, error, reference, out;
  int threads = 1, history = -1;
  double max_seconds = 600, memory_limit = 8192, accuracy = 0.01;
  bool resume = false, json = false, quiet = false;
  ReportOption report;
};

const std::vector<ErrorKind> error_kinds{ErrorKind::position, ErrorKind::energy, ErrorKind::probe,
                                         ErrorKind::violation};

/// The problem files of a folder, or the problem itself.
std::vector<std::string> problems_of(const std::string& given) {
  std::error_code error;
  if (!fs::is_directory(given, error)) return {given};
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(given)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path().string());
  }
  if (files.empty()) throw UsageError(given + ": holds no problem files (*.json)");
  std::sort(files.begin(), files.end());
  return files;
}

ChartOptions options_of(const ChartArguments& arguments) {
  ChartOptions options;
  ChartChoice& choice = options.choice;
  for (const std::string& given : arguments.problems) {
    for (const std::string& problem : problems_of(given)) choice.problems.push_back(problem);
  }
  const bool many = choice.problems.size() > 1;
  choice.solvers = arguments.solvers;
  choice.reference = arguments.reference;
  choice.settings = parse_settings(arguments.settings);
  const std::string knob = arguments.knob.empty() && !many ? "tolerance" : arguments.knob;
  if (!knob.empty() && knob != "none") choice.knob = parse_knob(knob);
  for (const ErrorKind kind : error_kinds) {
    if (to_string(kind) == arguments.error) choice.error = kind;
  }
  choice.history_step = arguments.history < 0 && many ? 0 : arguments.history;
  options.find = find_problem;
  options.max_seconds = arguments.max_seconds;
  options.accuracy = arguments.accuracy;
  options.memory_limit_bytes = static_cast<std::int64_t>(arguments.memory_limit * (1 << 20));
  options.threads = arguments.threads;
  options.resume = arguments.resume;
  options.program = {"/proc/self/exe"};
  options.version = TAUT_VERSION;
  return options;
}

std::string progress_note(const ChartPoint& point) {
  return fmt::format("{}{}{}: {}", point.solver, point.value.empty() ? "" : " ", point.value, point.status);
}

int exit_code(const ChartData& data) {
  if (data.interrupted) return exit_interrupted;
  const bool no_reference = std::any_of(data.problems.begin(), data.problems.end(), [](const ProblemChart& problem) {
    return std::any_of(problem.references.begin(), problem.references.end(),
                       [](const ChartReference& reference) { return reference.kind == "missing"; });
  });
  return no_reference ? exit_not_solved : exit_solved;
}

int draw_chart(const ChartArguments& arguments) {
  const OutFolder folder(arguments.out, arguments.resume, "chart");
  arguments.report.check();
  ChartOptions options = options_of(arguments);
  options.stop = &stop_on_signals();
  options.folder = folder.path();
  TaskProgress progress("chart", arguments.quiet);
  options.on_start = [&](int tasks) { progress.begin(tasks); };
  options.on_task = [&](const ChartPoint& point) { progress.done(progress_note(point)); };
  const ChartData data = chart(options);
  progress.end(data.interrupted);

  const nlohmann::json report = chart_report(data, typed_command());
  write_atomically(options.folder / "report.json",
                   report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  write_atomically(options.folder / "chart.csv", chart_csv(data));
  write_report_pictures(options.folder, report);
  if (arguments.report.wanted()) arguments.report.write(report, arguments.quiet);

  const std::string text = arguments.json    ? chart_text(data)
                           : arguments.quiet ? ""
                                             : chart_terminal(data, arguments.out);
  const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  return printed ? exit_code(data) : exit_internal_error;
}

constexpr const char* footer =
    "\nWhat is turned (--vary), each with values of its own choice or yours (=V1,V2,...):\n"
    "  tolerance    all three of solver.tolerance (default for one problem)\n"
    "  step         time.step in s, to the same end time; of static problems the share of the load a step adds\n"
    "  mesh         the cells of every grid times these factors: mesh=0.5,1,2\n"
    "  integrator   time.integrator\n"
    "  penalty      the first penalty of augmented Lagrangians\n"
    "  model        problems, or lists of overrides: model=thin.json,thick.json or model='NAME:KEY=V;KEY=V',...\n"
    "  KEY          any other key of the problem: constraints.limit.form=matrix,singular_values\n"
    "\n"
    "What is measured (--error), at the end of the run:\n"
    "  position     largest distance of a vertex that all meshes share, over the diagonal of the scene\n"
    "  energy       the sum of energies, relative\n"
    "  probe        the probes of the problem; those with an expected value are a closed form\n"
    "  violation    the largest violation of any step, which needs no reference\n"
    "Without --error: probe where the problem has expected values, else position.\n"
    "\n"
    "The reference is the closed form, or else a tighter (tolerance / 100) or finer (step or width / 2) solution, by "
    "a\n"
    "method that is not charted where one solves it: ipopt, null_space, multiplier_loop, augmented_lagrangian are\n"
    "tried in this order, --reference asks for one. Its own error is estimated: from the next tolerance, or by\n"
    "Richardson's extrapolation of three steps or meshes. Errors below that say nothing.\n"
    "\n"
    "Every point is a `taut solve` in a process of its own, judged by residuals computed from problem and result\n"
    "alone; a run goes on after a step that is not solved. Failures are drawn hollow, those without an error at the\n"
    "top. A crash or a limit ends one run, never the chart.\n"
    "\n"
    "Several problems or a folder: performance profiles, data profiles and means over all, a problem at one value\n"
    "being an instance; correct is what is solved with an error of at most --accuracy.\n"
    "\n"
    "Files in DIR: chart.json (everything, with the command of each point), chart.csv, report.json, SVG charts, and\n"
    "runs/ with what each `taut solve` wrote. --report DIR writes one HTML page, DIR/index.html, with all charts.\n"
    "\n"
    "Exit codes: 0 the chart is complete, whatever failed in it; 1 internal error; 2 wrong usage or input;\n"
    "3 complete, but a reference was not solved; 130 interrupted, finished runs are kept.\n"
    "\n"
    "Examples:\n"
    "  taut chart hanging_cloth --set bodies.cloth.mesh.grid.cells=[16,16] --out out/tolerance\n"
    "  taut chart stretched_strip --vary mesh=0.25,0.5,1,2 --solvers augmented_lagrangian --out out/mesh\n"
    "  taut chart problems/catalogue --solvers augmented_lagrangian,multiplier_loop --max-seconds 60 --out out/all";

void add_choice(CLI::App& command, ChartArguments& arguments) {
  const auto list = CLI::MultiOptionPolicy::TakeAll;
  command
      .add_option("PROBLEM", arguments.problems,
                  "Problem files, names of problems of the catalogue, or folders of files")
      ->required();
  command
      .add_option("--solvers", arguments.solvers,
                  "Which solvers, separated by commas (default augmented_lagrangian,multiplier_loop,ipopt)")
      ->type_name("A,B,...")
      ->expected(1)
      ->delimiter(',')
      ->multi_option_policy(list);
  command.add_option("--vary", arguments.knob, "What is turned from point to point; none: nothing")
      ->type_name("KNOB[=V1,V2,...]");
  command.add_option("--error", arguments.error, "What is measured: position, energy, probe or violation")
      ->type_name("KIND")
      ->check(CLI::IsMember({"position", "energy", "probe", "violation"}));
  command.add_option("--reference", arguments.reference, "Solver of the reference")->type_name("A");
  command
      .add_option("--set", arguments.settings,
                  "Replace a value of the problem for every run, with a dotted key; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(list);
  command
      .add_option("--history", arguments.history,
                  "The step whose iterates are charted for each solver; 0: none (default: the last step, none for "
                  "several problems)")
      ->type_name("STEP")
      ->check(CLI::Range(0, 1000000000));
}

}  // namespace

void add_chart(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("chart", "Chart the error of solvers against what it costs");
  std::string solvers = "\nSolvers:\n";
  for (const SolverEntry& entry : solver_entries())
    solvers += fmt::format("  {:<22} {}\n", entry.label, entry.description);
  command->footer(solvers + footer);
  const auto arguments = std::make_shared<ChartArguments>();
  add_choice(*command, *arguments);
  command
      ->add_option("--accuracy", arguments->accuracy,
                   "Error up to which a solved run is correct, for profiles and means (default 0.01)")
      ->type_name("E")
      ->check(CLI::PositiveNumber);
  command->add_option("--threads", arguments->threads, "Threads of each solver (default 1); 0: the machine's cores")
      ->type_name("N")
      ->check(CLI::Range(0, 255));
  command->add_option("--max-seconds", arguments->max_seconds, "Seconds for each run (default 600)")
      ->type_name("S")
      ->check(CLI::PositiveNumber);
  command->add_option("--memory-limit", arguments->memory_limit, "MB for each run (default 8192); 0: no limit")
      ->type_name("MB")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--out", arguments->out, "Write everything to this directory")->type_name("DIR");
  add_report_option(*command, arguments->report);
  command->add_flag("--resume", arguments->resume, "Take over what is finished in DIR");
  command->add_flag("--json", arguments->json, "Print chart.json on standard output, and nothing else there");
  command->add_flag("--quiet", arguments->quiet, "No progress and no tables: errors only");
  command->callback([arguments, &code] { code = draw_chart(*arguments); });
}

}  // namespace taut
