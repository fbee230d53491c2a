#include "report/stress_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "report/command_text.h"
#include "report/text_table.h"
#include "study/solver_entries.h"
#include "study/stress_frontiers.h"

namespace taut {
namespace {

using Json = nlohmann::json;

/// The methods of all entries, in the order in which they first occur.
std::vector<std::string> methods_of(const StressAtlas& atlas) {
  std::vector<std::string> methods;
  for (const StressMap& map : atlas.maps) {
    for (const std::string& method : map.entry.methods) {
      if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
    }
  }
  return methods;
}

int count(const std::vector<StressCell>& row, StressOutcome outcome) {
  return static_cast<int>(
      std::count_if(row.begin(), row.end(), [outcome](const StressCell& cell) { return cell.outcome == outcome; }));
}

/// "up to 1e4 (+1), 2 false": the frontier, what is solved beyond it, and what must not be.
std::string reach(const StressEntry& entry, const std::vector<StressCell>& row) {
  const int values = static_cast<int>(row.size()), first = frontier(row), solved = count(row, StressOutcome::solved);
  if (count(row, StressOutcome::not_applicable) == values) return "-";
  std::string text = first == values ? "all"
                     : first == 0    ? "none"
                                     : "up to " + entry.values[static_cast<std::size_t>(first - 1)].label;
  if (solved > first) text += fmt::format(" (+{})", solved - first);
  for (const auto& [outcome, word] :
       {std::pair{StressOutcome::false_success, "FALSE"}, std::pair{StressOutcome::crash, "CRASH"}}) {
    if (const int bad = count(row, outcome); bad > 0) text += fmt::format(", {} {}", bad, word);
  }
  return text;
}

TextTable frontier_table(const StressAtlas& atlas) {
  const std::vector<std::string> methods = methods_of(atlas);
  TextTable table{{"entry", "from", "to"}};
  table[0].insert(table[0].end(), methods.begin(), methods.end());
  for (const StressMap& map : atlas.maps) {
    std::vector<std::string> row{map.entry.name, map.entry.values.front().label, map.entry.values.back().label};
    for (const std::string& method : methods) {
      const auto& own = map.entry.methods;
      const auto found = std::find(own.begin(), own.end(), method);
      row.push_back(found == own.end() ? "-"
                                       : reach(map.entry, map.cells[static_cast<std::size_t>(found - own.begin())]));
    }
    table.push_back(std::move(row));
  }
  return table;
}

/// The cells of a method, and those of the default one beside them (none where it was not run).
struct Rows {
  std::vector<StressCell> own, beside;
};

Rows cells_of(const StressAtlas& atlas, const std::string& method) {
  Rows rows;
  for (const StressMap& map : atlas.maps) {
    const auto& methods = map.entry.methods;
    const auto place = [&](const std::string& name) {
      return static_cast<std::size_t>(std::find(methods.begin(), methods.end(), name) - methods.begin());
    };
    const std::size_t own = place(method), other = place(default_method);
    if (own == methods.size()) continue;
    for (std::size_t v = 0; v < map.entry.values.size(); ++v) {
      if (map.cells[own][v].outcome == StressOutcome::not_applicable) continue;
      rows.own.push_back(map.cells[own][v]);
      if (other < methods.size()) rows.beside.push_back(map.cells[other][v]);
    }
  }
  return rows;
}

TextTable method_table(const StressAtlas& atlas) {
  TextTable table{{"method", "cells", "solved", "share", "the default solver there", "honest failures",
                   "false successes", "crashes", "time-outs"}};
  for (const std::string& method : methods_of(atlas)) {
    const auto [own, beside] = cells_of(atlas, method);
    const auto number = [&cells = own](StressOutcome outcome) { return std::to_string(count(cells, outcome)); };
    const auto share = [](const std::vector<StressCell>& cells) {
      if (cells.empty()) return std::string("-");
      return fmt::format("{:.1f} %", 100.0 * count(cells, StressOutcome::solved) / static_cast<double>(cells.size()));
    };
    table.push_back({method, std::to_string(own.size()), number(StressOutcome::solved), share(own), share(beside),
                     number(StressOutcome::honest_failure), number(StressOutcome::false_success),
                     number(StressOutcome::crash), number(StressOutcome::timeout)});
  }
  return table;
}

TextTable loss_table(const StressAtlas& atlas) {
  TextTable table{{"entry", "value", "solved by", "the default solver", "mechanism"}};
  for (const StressLoss& loss : losses(atlas))
    table.push_back({loss.entry, loss.value, loss.winner, loss.cell.text, loss.mechanism});
  return table;
}

/// What solves this cell's problem with files, pictures and all residuals.
std::string command_of(const StressEntry& entry, const std::string& method, const StressValue& value) {
  std::vector<std::string> words{"taut", "solve", entry.problem};
  for (const Overrides& some : {entry.overrides, solver_entry(method).overrides, value.overrides}) {
    for (const auto& [key, text] : some) words.insert(words.end(), {"--set", key + "=" + text});
  }
  return command_text(words);
}

Json heat_map(const StressMap& map) {
  Json values = Json::array(), cells = Json::array();
  for (const StressValue& value : map.entry.values) values.push_back(value.label);
  for (std::size_t m = 0; m < map.cells.size(); ++m) {
    Json row = Json::array();
    for (std::size_t v = 0; v < map.cells[m].size(); ++v) {
      const StressCell& cell = map.cells[m][v];
      row.push_back({{"outcome", to_string(cell.outcome)},
                     {"text", cell.text},
                     {"command", command_of(map.entry, map.entry.methods[m], map.entry.values[v])}});
    }
    cells.push_back(std::move(row));
  }
  return {{"id", map.entry.name}, {"title", map.entry.title},     {"knob", map.entry.knob},
          {"values", values},     {"methods", map.entry.methods}, {"cells", cells}};
}

Json json_table(const std::string& id, const std::string& title, const TextTable& table) {
  Json rows = Json::array();
  for (std::size_t k = 1; k < table.size(); ++k) rows.push_back(table[k]);
  return {{"id", id}, {"title", title}, {"columns", table[0]}, {"rows", rows}};
}

std::vector<std::string> summary(const StressAtlas& atlas) {
  std::size_t cells = 0;
  for (const StressMap& map : atlas.maps) cells += map.entry.methods.size() * map.entry.values.size();
  std::vector<std::string> lines{fmt::format("{} families of problems, {} cells of at most {:g} s each{}.",
                                             atlas.maps.size(), cells, atlas.max_seconds,
                                             atlas.interrupted ? "; interrupted" : "")};
  const std::vector<StressLoss> lost = losses(atlas);
  lines.push_back(fmt::format("The default solver loses {} of them: another method solves what it does not.",
                              lost.empty() ? "none" : std::to_string(lost.size())));
  return lines;
}

}  // namespace

Json stress_report(const StressAtlas& atlas, const std::string& command) {
  Json report{{"title", atlas.quick ? "Atlas of failure, quick" : "Atlas of failure"},
              {"command", command},
              {"version", atlas.version},
              {"machine", {{"cpu", atlas.machine.cpu}, {"cores", atlas.machine.cores}, {"os", atlas.machine.os}}},
              {"summary", summary(atlas)},
              {"settings", {{"seconds_per_cell", atlas.max_seconds}, {"quick", atlas.quick}}},
              {"heat_maps", Json::array()}};
  for (const StressMap& map : atlas.maps) report["heat_maps"].push_back(heat_map(map));
  report["tables"] = {json_table("methods", "Methods", method_table(atlas)),
                      json_table("frontiers", "Frontiers: what is solved from the easy end", frontier_table(atlas)),
                      json_table("losses", "Losses of the default solver", loss_table(atlas))};
  return report;
}

std::string stress_terminal(const StressAtlas& atlas, const std::string& folder) {
  std::string text = aligned(frontier_table(atlas)) + "\n" + aligned(method_table(atlas)) + "\n";
  for (const std::string& line : summary(atlas)) text += line + "\n";
  for (const StressLoss& loss : losses(atlas)) {
    text += fmt::format("  {} at {}: {}; {} solves it{}\n", loss.entry, loss.value, loss.cell.text, loss.winner,
                        loss.mechanism.empty() ? "" : ". " + loss.mechanism);
  }
  return text + (folder.empty()
                     ? "no files written; --out DIR keeps the result\n"
                     : "report.json, stress.md, frontiers.json and a heat map per entry are in " + folder + "\n");
}

std::string stress_markdown(const StressAtlas& atlas) {
  std::string text = "# Atlas of failure\n\n";
  for (const std::string& line : summary(atlas)) text += line + "\n";
  text += "\n## Methods\n\n" + markdown(method_table(atlas)) + "\n## Frontiers\n\n" + markdown(frontier_table(atlas));
  if (!losses(atlas).empty()) text += "\n## Losses of the default solver\n\n" + markdown(loss_table(atlas));
  return text + fmt::format("\nTaut {}, {} ({} cores), {}.\n", atlas.version, atlas.machine.cpu, atlas.machine.cores,
                            atlas.machine.os);
}

}  // namespace taut
