#include "cli/program.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/model.h"
#include "problems/scene.h"
#include "study/run_folder.h"

namespace taut {
namespace {

constexpr const char* description =
    "Taut solves time steps of strain-limited cloth, each as one constrained minimisation,\n"
    "and says how far each result is from optimal and which triangle violates what.";
constexpr const char* footer =
    "\nExamples:\n"
    "  taut list problems                        what there is to try\n"
    "  taut solve hanging_cloth --out out/cloth  solve one, keep the results\n"
    "  taut check out/cloth                      judge what is stored there once more\n"
    "  taut solve --help                         everything about solving\n"
    "  taut compare --help                       solvers against each other\n"
    "  taut chart --help                         speed against accuracy\n"
    "  taut lean --help                          the cheapest model that answers a question\n"
    "\n"
    "Exit codes: 0 solved within tolerance, 1 internal error or a file that cannot be written,\n"
    "2 wrong usage or input, 3 not solved (the result is written all the same), 130 interrupted.";

/// Errors are one line on standard error, whatever their text.
int fail(std::string text, ExitCode code) {
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  fmt::print(stderr, "taut: {}\n", text);
  return code;
}

int refuse(const CLI::App& program, const CLI::ParseError& error) {
  const auto chosen = program.get_subcommands();
  const CLI::App& command = chosen.empty() ? program : *chosen[0];
  std::string text = error.what();
  // CLI11 misses a sub-command where it was given an unknown one.
  const std::vector<std::string> left = command.remaining();
  if (dynamic_cast<const CLI::RequiredError*>(&error) && !left.empty()) text = "there is no command " + left[0];
  return fail(fmt::format("{}; see {} --help", text, chosen.empty() ? "taut" : "taut " + command.get_name()),
              exit_bad_input);
}

/// The exit code of `work`, or that of the exception it ends with.
template <class Work>
int guarded(const Work& work) {
  try {
    return work();
  } catch (const UsageError& error) {
    return fail(error.what(), exit_bad_input);
  } catch (const InputError& error) {
    return fail(error.what(), exit_bad_input);
  } catch (const RunRefused& error) {
    return fail(error.what(), exit_bad_input);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", exit_internal_error);
  } catch (const std::exception& error) {
    return fail(error.what(), exit_internal_error);
  }
}

}  // namespace

int run_program(int argc, char** argv) {
  if (is_ampl_call(argc, argv)) return guarded([&] { return run_as_ampl_solver(argc, argv); });
  CLI::App program(description, "taut");
  program.footer(footer);
  program.set_version_flag("-v,--version", "taut " TAUT_VERSION);
  program.require_subcommand(1);
  int code = exit_solved;
  add_solve(program, code);
  add_check(program, code);
  add_list(program, code);
  add_schema(program, code);
  add_compare(program, code);
  add_chart(program, code);
  add_lean(program, code);
  add_stress(program, code);
  add_modes(program, code);
  add_replay(program, code);
  add_compare_worker(program, code);
  add_suite_worker(program);
  return guarded([&]() -> int {
    try {
      program.parse(argc, argv);
      return code;
    } catch (const CLI::ParseError& error) {
      if (error.get_exit_code() == 0) {  // --help and --version come this way
        program.exit(error);
        return exit_solved;
      }
      return refuse(program, error);
    }
  });
}

}  // namespace taut
