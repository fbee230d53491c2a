#include "problems/schema.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "cli/commands.h"

namespace taut {

void add_schema(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("schema", "Print the JSON Schema of problem files");
  command->footer(
      "\nEvery key of a problem file with its description, unit, default and bounds, as a JSON Schema\n"
      "(draft-07). Editors that are pointed at it complete and check problem files as one types:\n"
      "  taut schema > taut.schema.json");
  command->callback([&code] {
    const std::string_view text = problem_schema();
    const bool printed = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
    code = printed ? exit_solved : exit_internal_error;
  });
}

}  // namespace taut
