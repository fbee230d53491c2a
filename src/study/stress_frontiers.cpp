#include "study/stress_frontiers.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "problems/schema.h"

namespace taut {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view letters = "shfct-";  // in the order of StressOutcome

std::vector<std::string> labels(const StressEntry& entry) {
  std::vector<std::string> all;
  for (const StressValue& value : entry.values) all.push_back(value.label);
  return all;
}

std::string letters_of(const std::vector<StressCell>& row) {
  std::string text;
  for (const StressCell& cell : row) text += letters[static_cast<std::size_t>(cell.outcome)];
  return text;
}

bool is_bad(StressOutcome outcome) {
  return outcome == StressOutcome::false_success || outcome == StressOutcome::crash;
}

/// The stored row of a method as cells; throws InputError where it does not fit the entry.
std::vector<StressCell> read_row(const Json& stored, std::size_t size, const std::string& source,
                                 const std::string& pointer) {
  const std::string text = stored.is_string() ? stored.get<std::string>() : "";
  const bool fits = text.size() == size && text.find_first_not_of(letters) == text.npos;
  if (!fits)
    throw InputError(source, pointer, "found " + stored.dump() + fmt::format(", allowed: {} of {}", size, letters));
  std::vector<StressCell> row(size);
  for (std::size_t k = 0; k < size; ++k) row[k].outcome = static_cast<StressOutcome>(letters.find(text[k]));
  return row;
}

std::string reach(const StressEntry& entry, int values) {
  return values == 0 ? "nothing" : "up to " + entry.values[static_cast<std::size_t>(values - 1)].label;
}

void compare_row(const StressEntry& entry, const std::string& method, const std::vector<StressCell>& row,
                 const std::vector<StressCell>& stored, std::vector<std::string>& worse) {
  const int now = frontier(row), before = frontier(stored);
  if (now < before) {
    worse.push_back(fmt::format("{}: {} solves {}, stored: {} ({})", entry.name, method, reach(entry, now),
                                reach(entry, before), row[static_cast<std::size_t>(now)].text));
  }
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (is_bad(row[k].outcome) && !is_bad(stored[k].outcome))
      worse.push_back(fmt::format("{} at {}: {} has a {}, stored: {} ({})", entry.name, entry.values[k].label, method,
                                  to_string(row[k].outcome), to_string(stored[k].outcome), row[k].text));
  }
}

}  // namespace

std::vector<StressLoss> losses(const StressAtlas& atlas) {
  std::vector<StressLoss> all;
  for (const StressMap& map : atlas.maps) {
    const auto& methods = map.entry.methods;
    const auto own = std::find(methods.begin(), methods.end(), default_method) - methods.begin();
    if (own == static_cast<std::ptrdiff_t>(methods.size())) continue;
    for (std::size_t k = 0; k < map.entry.values.size(); ++k) {
      const StressCell& cell = map.cells[static_cast<std::size_t>(own)][k];
      if (cell.outcome == StressOutcome::solved) continue;
      const auto winner = std::find_if(map.cells.begin(), map.cells.end(), [k](const std::vector<StressCell>& row) {
        return row[k].outcome == StressOutcome::solved;
      });
      if (winner == map.cells.end()) continue;
      const std::string& label = map.entry.values[k].label;
      const auto known = map.entry.losses.find(label);
      all.push_back({map.entry.name, label, methods[static_cast<std::size_t>(winner - map.cells.begin())], cell,
                     known == map.entry.losses.end() ? "" : known->second});
    }
  }
  return all;
}

std::string frontiers_text(const StressAtlas& atlas) {
  Json json = Json::object();
  for (const StressMap& map : atlas.maps) {
    Json& entry = json[map.entry.name];
    entry["values"] = fmt::format("{}", fmt::join(labels(map.entry), " "));
    for (std::size_t k = 0; k < map.cells.size(); ++k)
      entry["outcomes"][map.entry.methods[k]] = letters_of(map.cells[k]);
  }
  return json.dump(2) + "\n";
}

std::vector<std::string> regressions(const StressAtlas& atlas, const std::string& stored, const std::string& source) {
  const Json json = parse_strict(stored, source);
  std::vector<std::string> worse;
  for (const StressMap& map : atlas.maps) {
    const StressEntry& entry = map.entry;
    const Json known = json.is_object() ? json.value(entry.name, Json::object()) : Json::object();
    const std::string values = fmt::format("{}", fmt::join(labels(entry), " "));
    if (known.contains("values") && known["values"] != values)
      throw InputError(source, "/" + entry.name + "/values",
                       "found " + known["values"].dump() + ", allowed: " + values);
    const Json outcomes = known.value("outcomes", Json::object());
    for (std::size_t k = 0; k < map.cells.size(); ++k) {
      const std::string& method = entry.methods[k];
      if (outcomes.contains(method)) {
        const std::string pointer = "/" + entry.name + "/outcomes/" + method;
        compare_row(entry, method, map.cells[k], read_row(outcomes[method], map.cells[k].size(), source, pointer),
                    worse);
      }
      if (method != default_method) continue;
      for (std::size_t v = 0; v < map.cells[k].size(); ++v) {
        const StressCell& cell = map.cells[k][v];
        if (is_bad(cell.outcome))
          worse.push_back(fmt::format("{} at {}: the default solver has a {} ({})", entry.name, entry.values[v].label,
                                      to_string(cell.outcome), cell.text));
      }
    }
  }
  for (const StressLoss& loss : losses(atlas)) {
    if (loss.mechanism.empty())
      worse.push_back(
          fmt::format("{} at {}: {} solves it and the default solver does not ({}), for no reason that the "
                      "atlas names",
                      loss.entry, loss.value, loss.winner, loss.cell.text));
  }
  return worse;
}

}  // namespace taut
