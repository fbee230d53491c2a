#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
}

namespace taut {

/// What the program returns to the shell. docs/reference/cli.md says the same.
enum ExitCode {
  exit_solved = 0,
  exit_internal_error = 1,
  exit_bad_input = 2,
  exit_not_solved = 3,
  exit_interrupted = 130
};

/// A command that cannot be carried out as it was typed; what() is one line.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Each adds its sub-command to the program; the command writes its exit code to `code` when it is called.
void add_solve(CLI::App& program, int& code);
void add_check(CLI::App& program, int& code);
void add_list(CLI::App& program, int& code);
void add_schema(CLI::App& program, int& code);
void add_compare(CLI::App& program, int& code);
void add_chart(CLI::App& program, int& code);
void add_lean(CLI::App& program, int& code);
void add_modes(CLI::App& program, int& code);
void add_replay(CLI::App& program, int& code);
void add_stress(CLI::App& program, int& code);
void add_compare_worker(CLI::App& program, int& code);  // what compare starts; in no help
void add_suite_worker(CLI::App& program);               // the same with --suite

/// The folder of the problems that come with the program: beside an installed program, or else in the sources.
std::filesystem::path catalogue_folder();

}  // namespace taut
