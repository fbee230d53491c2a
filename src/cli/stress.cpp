#include "study/stress.h"

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
#include "report/html_report.h"
#include "report/stress_report.h"
#include "study/machine.h"
#include "study/stress_frontiers.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

struct StressArguments {
  std::vector<std::string> methods, entries;
  std::string out, against;
  double max_seconds = 20;
  int threads = 0;
  bool quick = false, json = false, quiet = false;
  ReportOption report;
};

void write_files(const fs::path& folder, const StressAtlas& atlas, const nlohmann::json& report) {
  fs::create_directories(folder);
  write_atomically(folder / "report.json", report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  write_atomically(folder / "stress.md", stress_markdown(atlas));
  write_atomically(folder / "frontiers.json", frontiers_text(atlas));
  write_report_pictures(folder, report);
}

int make_atlas(const StressArguments& arguments) {
  arguments.report.check();
  const std::string stored = arguments.against.empty() ? "" : read_bytes(arguments.against);
  const TemporaryFolder temporary;
  StressOptions options;
  options.atlas = catalogue_folder() / "stress" / "atlas.json";
  options.methods = arguments.methods;
  options.entries = arguments.entries;
  options.quick = arguments.quick;
  options.threads = arguments.threads > 0 ? arguments.threads : this_machine().cores;
  options.max_seconds = arguments.max_seconds;
  options.folder = temporary.path();
  options.worker = {"/proc/self/exe", "compare-worker"};
  options.stop = &stop_on_signals();
  options.version = TAUT_VERSION;
  TaskProgress progress("stress", arguments.quiet);
  options.on_start = [&](int cells) { progress.begin(cells); };
  options.on_cell = [&](const std::string& name, const StressCell& cell) {
    progress.done(fmt::format("{}: {}", name, to_string(cell.outcome)));
  };
  const StressAtlas atlas = stress(options);
  progress.end(atlas.interrupted);
  if (atlas.interrupted) return exit_interrupted;

  const nlohmann::json report = stress_report(atlas, typed_command());
  if (!arguments.out.empty()) write_files(arguments.out, atlas, report);
  if (arguments.report.wanted()) arguments.report.write(report, arguments.quiet);
  const std::string text = arguments.json ? report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"
                           : arguments.quiet ? ""
                                             : stress_terminal(atlas, arguments.out);
  const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!printed) return exit_internal_error;
  if (arguments.against.empty()) return exit_solved;
  const std::vector<std::string> worse = regressions(atlas, stored, arguments.against);
  for (const std::string& line : worse) fmt::print(stderr, "worse: {}\n", line);
  return worse.empty() ? exit_solved : exit_not_solved;
}

constexpr const char* footer =
    "\nWhat happens: each entry of problems/catalogue/stress/atlas.json is a family of problems with a knob turned "
    "from "
    "easy\n"
    "to impossible. Every method solves every one, in a process of its own, and residuals computed from problem and\n"
    "result alone judge it: solved, honest failure (a status with a name, or an input that is refused), false success "
    "(the\n"
    "method says solved and the residuals do not, or it says infeasible and another method solves the problem), crash, "
    "or\n"
    "time-out.\n"
    "\n"
    "Files in DIR: report.json, stress.md, frontiers.json, and an SVG heat map (knob x method) per entry.\n"
    "--report DIR writes one HTML page, DIR/index.html, with all of them.\n"
    "\n"
    "Exit codes: 0 the atlas is complete; 1 internal error; 2 wrong usage or input; 3 --against found something "
    "worse;\n"
    "130 interrupted.\n"
    "\n"
    "Examples:\n"
    "  taut stress --quick\n"
    "  taut stress --entry snap_through,time_step_long --method augmented_lagrangian,ipopt --out out/stress";

}  // namespace

void add_stress(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("stress", "Where which method fails: an atlas of hard problems");
  command->footer(footer);
  const auto arguments = std::make_shared<StressArguments>();
  const auto list = CLI::MultiOptionPolicy::TakeAll;
  command->add_option("--method", arguments->methods, "Only these methods (those of taut compare --solvers)")
      ->type_name("A,B,...")
      ->expected(1)
      ->delimiter(',')
      ->multi_option_policy(list);
  command->add_option("--entry", arguments->entries, "Only these entries of the atlas")
      ->type_name("A,B,...")
      ->expected(1)
      ->delimiter(',')
      ->multi_option_policy(list);
  command->add_flag("--quick", arguments->quick, "A few values of each knob: less than a minute or two");
  command->add_option("--max-seconds", arguments->max_seconds, "Wall clock of each cell (default 20)")
      ->type_name("S")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--threads", arguments->threads,
                   "Cells at a time, each solved by one thread; 0, the default: the machine's cores")
      ->type_name("N")
      ->check(CLI::Range(0, 255));
  command->add_option("--out", arguments->out, "Write the report and the heat maps to this directory")
      ->type_name("DIR");
  add_report_option(*command, arguments->report);
  command
      ->add_option("--against", arguments->against,
                   "Exit code 3 where something is worse than this frontiers.json says, or where the default solver "
                   "lies, crashes or loses without a known mechanism")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  command->add_flag("--json", arguments->json, "Print report.json on standard output, and nothing else there");
  command->add_flag("--quiet", arguments->quiet, "No progress and no tables: errors only");
  command->callback([arguments, &code] { code = make_atlas(*arguments); });
}

}  // namespace taut
