#include "study/compare_records.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "study/pareto.h"

namespace taut {
namespace {

/// Raises `largest` to `value`; a NaN is larger than everything.
void raise(double& largest, double value) {
  if (!(value <= largest)) largest = value;
}

double largest_ratio(const Residuals& residuals, const Tolerances& tolerance) {
  return std::max({residuals.stationarity / tolerance.stationarity, residuals.feasibility / tolerance.feasibility,
                   residuals.complementarity / tolerance.complementarity});
}

struct Place {
  std::size_t entry, trial;
};

void measure_step(std::vector<EntryRun>& entries, const std::vector<Place>& places, const Tolerances& tolerance,
                  double size, const PositionsOf& positions) {
  const auto trial = [&](const Place& place) -> StepTrial& { return entries[place.entry].trials[place.trial]; };
  std::vector<Place> converged;
  std::copy_if(places.begin(), places.end(), std::back_inserter(converged),
               [&](const Place& place) { return trial(place).residuals.within(tolerance); });
  if (converged.empty()) return;
  const Place best = *std::min_element(converged.begin(), converged.end(), [&](const Place& a, const Place& b) {
    return largest_ratio(trial(a).residuals, tolerance) < largest_ratio(trial(b).residuals, tolerance);
  });
  const StepTrial& reference = trial(best);
  const Vector x = positions(best.entry, best.trial);
  const double scale =
      std::max(std::abs(reference.objective), std::abs(reference.objective_at_start - reference.objective));
  for (const Place& place : places) {
    const Vector other = positions(place.entry, place.trial);
    if (other.size() != x.size()) continue;
    Distance distance;
    distance.reference = entries[best.entry].label;
    for (Index node = 0; node < x.size() / 3; ++node) {
      raise(distance.positions, (other.segment<3>(3 * node) - x.segment<3>(3 * node)).norm() / size);
    }
    const double difference = std::abs(trial(place).objective - reference.objective);
    distance.objective = difference == 0 ? 0 : difference / scale;
    trial(place).distance = distance;
  }
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  if (values.empty()) throw std::invalid_argument("spread_of: expected values, got none");
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
  return {median, values.front(), values.back()};
}

EntrySummary summarize(const EntryRun& run) {
  EntrySummary summary;
  std::vector<double> seconds;  // sum over the steps, by repeat
  for (const StepTrial& trial : run.trials) {
    if (trial.judged == Status::solved) {
      ++summary.solved;
    } else {
      ++summary.failures[std::string(to_string(trial.judged))];
    }
    summary.false_successes += trial.false_success();
    const Residuals& r = trial.residuals;
    for (const double value : {r.stationarity, r.feasibility, r.complementarity}) raise(summary.residual, value);
    if (trial.distance) {
      ++summary.distances;
      raise(summary.position_distance, trial.distance->positions);
      raise(summary.objective_distance, trial.distance->objective);
    }
    summary.linear_solves += static_cast<double>(trial.result.counts.linear_solves);
    // A step that was cut short has fewer repeats than the others: it counts in those it has.
    seconds.resize(std::max(seconds.size(), trial.seconds.size()), 0.0);
    for (std::size_t k = 0; k < trial.seconds.size(); ++k) seconds[k] += trial.seconds[k];
  }
  const int missing = run.steps_asked - static_cast<int>(run.trials.size());
  if (missing > 0) summary.failures[run.outcome == "finished" ? "not_reached" : run.outcome] += missing;
  if (run.trials.empty()) return summary;
  const auto count = static_cast<double>(run.trials.size());
  summary.linear_solves /= count;
  for (double& sum : seconds) sum /= count;
  summary.seconds = spread_of(seconds);
  return summary;
}

void measure_distances(std::vector<EntryRun>& entries, const Tolerances& tolerance, double size,
                       const PositionsOf& positions) {
  std::map<std::pair<std::string, int>, std::vector<Place>> steps;  // by group and step
  for (std::size_t entry = 0; entry < entries.size(); ++entry) {
    for (std::size_t trial = 0; trial < entries[entry].trials.size(); ++trial) {
      steps[{entries[entry].group, entries[entry].trials[trial].step}].push_back({entry, trial});
    }
  }
  for (const auto& [key, places] : steps) measure_step(entries, places, tolerance, size, positions);
}

void mark_front(std::vector<EntryRun>& entries) {
  std::map<std::string, std::vector<EntryRun*>> groups;
  for (EntryRun& run : entries) {
    run.on_front = false;
    groups[run.group].push_back(&run);
  }
  for (const auto& [group, members] : groups) {
    std::vector<WorkPrecision> work;
    for (const EntryRun* run : members) {
      const EntrySummary s = summarize(*run);
      const bool counts = s.solved == run->steps_asked && s.false_successes == 0 && s.distances > 0;
      work.push_back({s.seconds.median, counts ? s.position_distance : std::numeric_limits<double>::quiet_NaN()});
    }
    for (const std::size_t k : pareto_front(work)) members[k]->on_front = true;
  }
}

}  // namespace taut
