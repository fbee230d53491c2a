#include "cli/report_option.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "cli/commands.h"
#include "files/atomic_file.h"
#include "report/command_text.h"
#include "report/html_report.h"
#include "study/child_process.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

constexpr double longest_drawing = 60;  // s, of one PNG
constexpr const char* painter = "rsvg-convert";

/// Draws an SVG as the PNG of the same name, two pixels for each of its units.
void draw_png(const fs::path& svg) {
  const fs::path png = fs::path(svg).replace_extension(".png"), log = fs::path(svg).replace_extension(".log");
  const ChildOutcome outcome =
      run_child({painter, "--zoom", "2", "--output", png.string(), svg.string()}, log, {.seconds = longest_drawing});
  if (outcome.end != ChildEnd::exited || outcome.code != 0)
    throw std::runtime_error(fmt::format("{} could not draw {} ({} says why)", painter, svg.string(), log.string()));
  fs::remove(log);
}

}  // namespace

void ReportOption::check() const {
  if (png && !wanted()) throw UsageError("--png needs --report DIR, whose charts it draws");
  if (!wanted()) return;
  if (!has_report_page())
    throw UsageError("--report: this program was built without the report's page, because node and npm were missing");
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw UsageError("--report " + folder + ": is not a directory");
  if (png && run_child({painter, "--version"}, "/dev/null", {.seconds = longest_drawing}).code != 0)
    throw UsageError(std::string("--png needs ") + painter +
                     ", which is not installed (Debian's package librsvg2-bin)");
}

void ReportOption::write(const nlohmann::json& report, bool quiet) const {
  const std::vector<fs::path> files = write_html_report(folder, report);
  if (png) {
    for (std::size_t i = 1; i < files.size(); ++i) draw_png(files[i]);
  }
  if (quiet) return;
  fmt::print(stderr, "report: {} ({:.1f} MB), {} charts beside it\n", files.front().string(),
             static_cast<double>(fs::file_size(files.front())) / 1e6, files.size() - 1);
}

void add_report_option(CLI::App& command, ReportOption& option) {
  command
      .add_option("--report", option.folder,
                  "Write a report to this directory: one HTML page that needs no network, and its charts as SVG")
      ->type_name("DIR");
  command.add_flag("--png", option.png, "With --report: its charts as PNG as well (needs rsvg-convert)");
}

std::string typed_command() {
  const std::string bytes = read_bytes("/proc/self/cmdline");
  std::vector<std::string> words{"taut"};
  for (std::size_t begin = bytes.find('\0') + 1; begin < bytes.size();) {
    const std::size_t end = bytes.find('\0', begin);
    words.push_back(bytes.substr(begin, end - begin));
    begin = end == bytes.npos ? bytes.size() : end + 1;
  }
  return command_text(words);
}

}  // namespace taut
