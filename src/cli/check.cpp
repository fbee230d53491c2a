#include "study/check.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/lean.h"
#include "files/atomic_file.h"
#include "report/check_report.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

struct CheckArguments {
  std::string subject, csv, out;
  std::vector<std::string> frames, settings;
  std::optional<double> step, first_time;
  std::string tolerance;  // a number, or that of an answer
  double largest_fold = FrameOptions{}.largest_fold;
  bool lean = false, json = false, quiet = false;
  LeanArguments question;  // of --lean

  std::optional<double> violation() const;
};

/// --tolerance of violations, where it is given.
std::optional<double> CheckArguments::violation() const {
  if (tolerance.empty()) return {};
  char* end = nullptr;
  const double value = std::strtod(tolerance.c_str(), &end);
  if (*end != '\0' || !std::isfinite(value) || !(value > 0))
    throw UsageError("--tolerance: expected a number above 0, got " + tolerance);
  return value;
}

CheckReport frames_report(const CheckArguments& arguments) {
  std::error_code error;
  const bool is_run = fs::is_directory(arguments.subject, error);
  const fs::path problem = is_run ? fs::path(arguments.subject) / "problem.json" : find_problem(arguments.subject);
  const Scene scene = read_scene(problem, parse_settings(arguments.settings));
  return check_frames(
      scene, {arguments.frames, arguments.step, arguments.first_time, arguments.violation(), arguments.largest_fold});
}

CheckReport run_report(const CheckArguments& arguments) try {
  if (!arguments.settings.empty() || arguments.step || arguments.first_time) {
    throw UsageError("--set, --dt and --first-time are for frames of another program (--frames PATTERN)");
  }
  std::error_code error;
  if (!fs::is_directory(arguments.subject, error)) {
    throw UsageError(arguments.subject + ": is not the directory of a run; to judge other files, add --frames PATTERN");
  }
  return check_run(arguments.subject, arguments.violation());
} catch (const FileError& error) {  // files that are read: bad input
  throw UsageError(error.what());
}

void write_files(const CheckArguments& arguments, const CheckReport& report) try {
  if (!arguments.out.empty()) {
    make_folder(arguments.out);
    write_atomically(fs::path(arguments.out) / "check.json", check_json(report));
    write_atomically(fs::path(arguments.out) / "check.csv", check_csv(report));
  }
  if (!arguments.csv.empty()) write_atomically(arguments.csv, check_csv(report));
} catch (const FileError& error) {
  throw UsageError(error.what());
}

/// `taut check --lean`: what of the problem could go.
int check_lean(const CheckArguments& arguments) {
  if (!arguments.frames.empty() || !arguments.csv.empty() || arguments.step || arguments.first_time)
    throw UsageError("--frames, --csv, --dt and --first-time do not go with --lean");
  LeanArguments question = arguments.question;
  question.problem = arguments.subject;
  question.settings = arguments.settings;
  question.out = arguments.out;
  question.json = arguments.json;
  question.quiet = arguments.quiet;
  if (!arguments.tolerance.empty()) question.tolerance = arguments.tolerance;
  return check_lean_problem(question);
}

int check(const CheckArguments& arguments) {
  if (arguments.lean) return check_lean(arguments);
  const CheckReport report = arguments.frames.empty() ? run_report(arguments) : frames_report(arguments);
  write_files(arguments, report);
  const std::string text = arguments.json ? check_json(report) : arguments.quiet ? "" : check_table(report);
  const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!report.unusable.empty()) {
    const std::size_t others = report.unusable.size() - 1;
    fmt::print(stderr, "taut: {}{}\n", report.unusable[0], others > 0 ? fmt::format("; and {} more", others) : "");
  }
  if (!printed) return exit_internal_error;
  if (report.verdict() == CheckVerdict::unusable) return exit_bad_input;
  return report.verdict() == CheckVerdict::within ? exit_solved : exit_not_solved;
}

constexpr const char* footer =
    "\nA run of taut (DIR): the last step is posed anew from the state before it, and its residuals are computed from\n"
    "the stored positions and multipliers; every stored frame gives its violations and energies. What steps.jsonl and\n"
    "summary.json claim is compared with that: a claim that is not true is named, and so is every file that is "
    "missing.\n"
    "\n"
    "Files of another simulator (PROBLEM --frames): OBJ, PLY, OFF or VTU, with the vertices in the scene's order, "
    "bodies\n"
    "one after another in order of name. Strain limits, pins and obstacles are judged at the time of the frame, and\n"
    "faces that are turned over or degenerate are found. The number at the end of a file's name says which frame it "
    "is:\n"
    "frame k is step k of the problem, unless --dt or --first-time say otherwise; then the first frame is at the "
    "first\n"
    "time (0) and each further number is --dt later (the problem's time step). Numbers that are missing are named.\n"
    "Quote patterns, so that a pattern that matches nothing is noticed.\n"
    "\n"
    "A problem that models too much (PROBLEM --lean): it is solved as written, then once without each energy, limit,\n"
    "obstacle, load, layer, and with each setting one level coarser; named are those without which --quantity changes\n"
    "by at most --tolerance.\n"
    "\n"
    "Exit codes: 0 all within tolerance, 1 internal error, 2 wrong usage or input: no run, a missing or damaged file,\n"
    "other vertices or faces, a NaN, or a file that cannot be written; 3 something is violated or a claim is not "
    "true.\n"
    "\n"
    "Examples:\n"
    "  taut check out/cloth\n"
    "  taut check hanging_cloth --frames 'other/cloth_*.obj' --tolerance 1e-4\n"
    "  taut check problem.json --frames 'a/*.ply' --dt 0.04 --first-time 0.5 --csv check.csv\n"
    "  taut check out/cloth --json | jq .findings\n"
    "  taut check trampoline --lean --quantity displacement --tolerance 1%";

CLI::Validator number(const char* name, bool (*allowed)(double)) {
  return CLI::Validator(
      [name, allowed](const std::string& text) {
        char* end = nullptr;
        const double value = std::strtod(text.c_str(), &end);
        const bool good = end != text.c_str() && *end == '\0' && std::isfinite(value) && allowed(value);
        return good ? std::string() : "expected a number" + std::string(name) + ", got " + text;
      },
      "");
}

}  // namespace

void add_check(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("check", "Judge a stored run, or positions that another program wrote");
  command->footer(footer);
  const auto arguments = std::make_shared<CheckArguments>();
  const auto positive = number(" above 0", [](double value) { return value > 0; });
  command
      ->add_option("SUBJECT", arguments->subject,
                   "The directory of a run (solve --out); with --frames or --lean a problem file or the name of one")
      ->required();
  command->add_option("--frames", arguments->frames, "Files to judge, a pattern in quotes or names; may be repeated")
      ->type_name("PATTERN");
  command
      ->add_option("--tolerance", arguments->tolerance,
                   "Violations allowed: singular values, and lengths relative to the scene's size; without it the "
                   "problem's solver.tolerance.feasibility. With --lean: of the answer, as in taut lean (5%)")
      ->type_name("X");
  command->add_option("--dt", arguments->step, "Seconds (static: load fraction) from one frame number to the next")
      ->type_name("S")
      ->check(positive);
  command->add_option("--first-time", arguments->first_time, "Time of the first frame, s")
      ->type_name("S")
      ->check(number("", [](double) { return true; }));
  command
      ->add_option("--max-fold", arguments->largest_fold,
                   "Degrees from two neighbours beyond which a face counts as inverted; 150 without it, 180: never")
      ->type_name("DEG")
      ->check(number(" above 0", [](double value) { return value > 0; }));
  command
      ->add_option("--set", arguments->settings,
                   "With --frames: replace a value of the problem, with a dotted key; may be repeated")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_flag("--lean", arguments->lean,
                    "Solve PROBLEM without each thing that it could do without, and name what makes no difference");
  add_lean_question(*command, arguments->question);
  command->add_option("--csv", arguments->csv, "Write a line for each frame and constraint to this file")
      ->type_name("FILE");
  command->add_option("--out", arguments->out, "Write check.json and check.csv to this directory")->type_name("DIR");
  command->add_flag("--json", arguments->json, "Print check.json on standard output, and nothing else there");
  command->add_flag("--quiet", arguments->quiet, "Print nothing but a line on what cannot be judged");
  command->callback([arguments, &code] { code = check(*arguments); });
}

}  // namespace taut
