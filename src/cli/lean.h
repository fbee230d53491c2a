#pragma once

#include <string>
#include <vector>

#include "cli/report_option.h"

namespace CLI {
class App;
}

namespace taut {

/// What `taut lean` and `taut check --lean` are told.
struct LeanArguments {
  std::string problem, quantity = "displacement", tolerance = "5%", out, known;
  std::vector<std::string> settings;
  double max_seconds = 0, memory_limit = 8192;
  int threads = 1;
  bool json = false, quiet = false;
  ReportOption report;
};

/// What both have: --quantity, --max-seconds, --threads, --memory-limit.
void add_lean_question(CLI::App& command, LeanArguments& arguments);

/// `taut check --lean`: names what of a problem could go. Returns the exit code.
int check_lean_problem(const LeanArguments& arguments);

}  // namespace taut
