#include "study/history.h"

#include <fmt/format.h>

#include <cstdlib>
#include <iterator>
#include <sstream>
#include <string_view>

#include "core/residuals.h"
#include "core/stopwatch.h"
#include "files/atomic_file.h"

namespace taut {
namespace {

constexpr std::string_view head = "iteration,linear_solves,seconds,stationarity,feasibility,complementarity,penalty";

}  // namespace

History::History(Solver& solver, const Problem& problem)
    : solver_(solver), problem_(problem), start_(std::chrono::steady_clock::now()) {
  solver_.observer = [this](const Iterate& iterate) { take(iterate); };
}

History::~History() { solver_.observer = nullptr; }

void History::take(const Iterate& iterate) {
  const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  HistoryPoint point{.linear_solves = iterate.counts.linear_solves, .seconds = now - judging_};
  const Stopwatch watch(judging_);
  const Residuals r = Judge(problem_, iterate.x)(iterate.multipliers);
  point.stationarity = r.stationarity;
  point.feasibility = r.feasibility;
  point.complementarity = r.complementarity;
  point.penalty = iterate.penalty;
  points_.push_back(point);
}

std::string history_csv(const std::vector<HistoryPoint>& points) {
  std::string text = std::string(head) + "\n";
  for (std::size_t k = 0; k < points.size(); ++k) {
    const HistoryPoint& p = points[k];
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{}\n", k, p.linear_solves, p.seconds, p.stationarity,
                   p.feasibility, p.complementarity, p.penalty);
  }
  return text;
}

std::vector<HistoryPoint> read_history(const std::filesystem::path& file) {
  std::istringstream text(read_bytes(file));
  std::string line;
  if (!std::getline(text, line) || line != head) throw FileError(file, "line 1: is no history of taut");
  std::vector<HistoryPoint> points;
  while (std::getline(text, line)) {
    std::vector<double> values;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::strtod(cell.c_str(), nullptr));
    if (values.size() != 7) throw FileError(file, fmt::format("line {}: expected 7 numbers", points.size() + 2));
    points.push_back({.linear_solves = static_cast<long>(values[1]),
                      .seconds = values[2],
                      .stationarity = values[3],
                      .feasibility = values[4],
                      .complementarity = values[5],
                      .penalty = values[6]});
  }
  return points;
}

}  // namespace taut
