#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace CLI {
class App;
}

namespace taut {

/// --report DIR and --png of a command.
struct ReportOption {
  std::string folder;
  bool png = false;

  bool wanted() const { return !folder.empty(); }
  /// Refuses before any work is done what could not be carried out after it. Throws UsageError.
  void check() const;
  /// Writes the report and names the page and its size on standard error, unless `quiet`.
  void write(const nlohmann::json& report, bool quiet) const;
};

void add_report_option(CLI::App& command, ReportOption& option);

/// The command line of this process, as one would type it.
std::string typed_command();

}  // namespace taut
