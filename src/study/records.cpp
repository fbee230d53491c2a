#include "study/records.h"

#include <algorithm>

namespace taut {
namespace {

/// True where `value` is larger than `worst`; a NaN is larger than everything.
bool exceeds(double value, double worst) { return !(value <= worst); }

void take_worst(Worst& worst, double scaled, double unscaled, int step) {
  if (exceeds(scaled, worst.scaled)) worst = {scaled, unscaled, step};
}

WorstViolation& violation_of(RunSummary& summary, const std::string& constraint) {
  const auto found = std::find_if(summary.violations.begin(), summary.violations.end(),
                                  [&](const WorstViolation& v) { return v.constraint == constraint; });
  if (found != summary.violations.end()) return *found;
  summary.violations.emplace_back().constraint = constraint;
  return summary.violations.back();
}

}  // namespace

void add_step(RunSummary& summary, const StepRecord& record) {
  const Residuals& r = record.residuals;
  summary.steps_done = record.step;
  if (record.status == Status::solved) {
    ++summary.steps_solved;
  } else if (summary.status == Status::solved) {
    summary.status = record.status;
    summary.message = "step " + std::to_string(record.step) + ": " + record.message;
  }
  summary.objective = record.objective;
  if (exceeds(r.stationarity, summary.stationarity.scaled)) {
    summary.force_scale = r.force_scale;
    summary.worst_node = r.worst_node;
  }
  take_worst(summary.stationarity, r.stationarity, r.stationarity_unscaled, record.step);
  take_worst(summary.feasibility, r.feasibility, r.feasibility_unscaled, record.step);
  take_worst(summary.complementarity, r.complementarity, r.complementarity_unscaled, record.step);
  for (const Violation& violation : r.violations) {
    WorstViolation& worst = violation_of(summary, violation.constraint);
    if (!exceeds(violation.max, worst.max)) continue;
    worst.max = violation.max;
    worst.where = violation.where;
    worst.step = record.step;
  }
  for (const Penetration& penetration : record.penetrations) {
    std::optional<Penetration>& deepest = violation_of(summary, penetration.constraint).penetration;
    if (!deepest) deepest = penetration;
    deepest->edge = std::max(deepest->edge, penetration.edge);
    deepest->face = std::max(deepest->face, penetration.face);
  }
  if (!record.modes.empty()) summary.modes = record.modes;
  for (const auto& [name, value] : record.probes) {
    const auto same = [&](const ProbeValue& probe) { return probe.name == name; };
    const auto probe = std::find_if(summary.probes.begin(), summary.probes.end(), same);
    if (probe != summary.probes.end()) probe->value = value;
  }
  summary.counts += record.counts;
  summary.seconds.solver += record.seconds;
  summary.seconds.judging += record.judging;
}

}  // namespace taut
