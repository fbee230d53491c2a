#include "study/lean.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/lean.h"
#include "cli/report_option.h"
#include "cli/stop_signals.h"
#include "cli/temporary_folder.h"
#include "files/atomic_file.h"
#include "report/html_report.h"
#include "report/lean_report.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

LeanOptions options_of(const LeanArguments& arguments) {
  LeanOptions options;
  options.problem = find_problem(arguments.problem);
  options.settings = parse_settings(arguments.settings);
  options.quantity = parse_quantity(arguments.quantity);
  options.tolerance = parse_tolerance(arguments.tolerance, options.quantity);
  options.max_seconds = arguments.max_seconds;
  options.memory_limit_bytes = static_cast<std::int64_t>(arguments.memory_limit * (1 << 20));
  options.threads = arguments.threads;
  options.program = {"/proc/self/exe"};
  options.version = TAUT_VERSION;
  options.known = arguments.known;
  options.stop = &stop_on_signals();
  if (!arguments.quiet) {
    options.on_rung = [](const LeanRung& rung) {
      fmt::print(stderr, "lean: {}: {} in {:.2f} s\n", rung.words, rung.status, rung.seconds);
    };
    options.on_estimate = [](const ResidualTrial& trial) {
      fmt::print(stderr, "lean: {}: {} in {:.2f} s\n", trial.words,
                 trial.answer ? "estimated from a residual" : "no estimate, " + trial.why, trial.seconds);
    };
  }
  return options;
}

int exit_code(const LeanOutcome& outcome) {
  if (outcome.end == LeanEnd::interrupted) return exit_interrupted;
  return outcome.end == LeanEnd::verified || outcome.end == LeanEnd::exact ? exit_solved : exit_not_solved;
}

bool print(const std::string& text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

int find_lean(const LeanArguments& arguments) {
  arguments.report.check();
  LeanOptions options = options_of(arguments);
  std::optional<TemporaryFolder> temporary;
  if (arguments.out.empty()) temporary.emplace();
  options.folder = temporary ? temporary->path() : fs::path(arguments.out);
  const LeanStudy study = lean(options);
  const nlohmann::json report = lean_report(study, typed_command());
  write_report_pictures(options.folder, report);
  if (arguments.report.wanted()) arguments.report.write(report, arguments.quiet);
  const std::string text = arguments.json    ? lean_text(study)
                           : arguments.quiet ? ""
                                             : lean_terminal(study, arguments.out);
  return print(text) ? exit_code(study.outcome) : exit_internal_error;
}

constexpr const char* footer =
    "\nThe question (--quantity), answered at the end of the run:\n"
    "  probe:NAME     a probe of the problem, in its own unit\n"
    "  displacement   the largest displacement of a vertex, m\n"
    "  shape          where the surfaces are: root mean square distance of their material points, m; relative\n"
    "                 tolerances are of the root mean square displacement\n"
    "  frequency:K    the K-th natural frequency of a static problem, Hz\n"
    "  tension        the largest tension of a triangle, N/m\n"
    "  energy         the sum of energies, J, relative to the sum of their magnitudes; energy:NAME one of them\n"
    "\n"
    "How exact (--tolerance): 5% or 0.05, relative; 2mm, 0.1Hz, 3N/m, 1J or abs:0.002, absolute.\n"
    "\n"
    "What happens: coarse meshes, long steps and loose tolerances are run first; what each changes, and what leaving\n"
    "out bending, limits, layers or covers changes, gives an estimate of the error; in static problems a residual may\n"
    "tell the former without a run (lines `residual`). A model that takes more linear solves than it is worth is "
    "given\n"
    "up. The cheapest model whose estimate times 1.5 is allowed is run and compared with the one above it. Where that\n"
    "does not confirm it the search goes on upwards, at worst to the scene as it is written, and says so.\n"
    "\n"
    "Files in DIR: NAME.lean.json (the model found; it runs), lean.json (everything), problems/ and runs/ (each model\n"
    "tried), pareto.svg. --report DIR writes one HTML page.\n"
    "\n"
    "Exit codes: 0 a model was found and verified, 1 internal error, 2 wrong usage or input, 3 the time was over or\n"
    "the full scene is not solved (the best found is written, not verified), 130 interrupted.\n"
    "\n"
    "Examples:\n"
    "  taut lean stretched_strip --quantity probe:lengthening --tolerance 1% --out out/lean\n"
    "  taut lean hanging_cloth --quantity shape --tolerance 2cm --max-seconds 60 --report out/lean_report\n"
    "  taut lean validation/frequencies_cantilever_plate --quantity frequency:1 --tolerance 1%";

}  // namespace

void add_lean_question(CLI::App& command, LeanArguments& arguments) {
  command.add_option("--quantity", arguments.quantity, "What is asked (default displacement)")->type_name("Q");
  command.add_option("--max-seconds", arguments.max_seconds, "Stop after this time with the best found (exit code 3)")
      ->type_name("S")
      ->check(CLI::PositiveNumber);
  command.add_option("--threads", arguments.threads, "Threads of each solver (default 1)")
      ->type_name("N")
      ->check(CLI::Range(1, 255));
  command.add_option("--memory-limit", arguments.memory_limit, "MB for each model (default 8192); 0: no limit")
      ->type_name("MB")
      ->check(CLI::NonNegativeNumber);
}

int check_lean_problem(const LeanArguments& arguments) {
  LeanOptions options = options_of(arguments);
  std::optional<TemporaryFolder> temporary;
  if (arguments.out.empty()) temporary.emplace();
  options.folder = temporary ? temporary->path() : fs::path(arguments.out);
  const LeanStudy study = check_lean(options);
  const std::string text = arguments.json ? lean_text(study) : arguments.quiet ? "" : lean_check_terminal(study);
  return print(text) ? exit_code(study.outcome) : exit_internal_error;
}

void add_lean(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("lean", "Find the cheapest model that answers a question about a problem");
  command->footer(footer);
  const auto arguments = std::make_shared<LeanArguments>();
  command->add_option("PROBLEM", arguments->problem, "A problem file, or the name of one in the catalogue")->required();
  add_lean_question(*command, *arguments);
  command->add_option("--tolerance", arguments->tolerance, "How exact the answer has to be (default 5%)")
      ->type_name("T");
  command
      ->add_option("--set", arguments->settings,
                   "Replace a value of the problem for every model, with a dotted key; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command
      ->add_option("--known", arguments->known,
                   "A run of the scene as written (solve --out): adds the true error of every model, changes no choice")
      ->type_name("DIR");
  command->add_option("--out", arguments->out, "Write everything to this directory")->type_name("DIR");
  add_report_option(*command, arguments->report);
  command->add_flag("--json", arguments->json, "Print lean.json on standard output, and nothing else there");
  command->add_flag("--quiet", arguments->quiet, "No progress and no tables: errors only");
  command->callback([arguments, &code] { code = find_lean(*arguments); });
}

}  // namespace taut
