#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "dynamics/modal/modal_basis.h"
#include "problems/build.h"
#include "solvers/curvature.h"
#include "study/check.h"
#include "study/examine.h"
#include "study/frame_files.h"
#include "study/records_json.h"
#include "study/stored_run.h"
#include "study/surface_fields.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

// A number that is stored with all its digits and computed again may differ by round-off, on another machine at least:
// by this much of the scale of what was summed. Residuals are small differences of large forces, and get some more.
constexpr double round_off = 1e-10;
constexpr double residual_round_off = 1e-6;  // of the residual itself

bool agree(double claimed, double found, double scale) {
  return (std::isnan(claimed) && std::isnan(found)) || std::abs(claimed - found) <= round_off * scale;
}

bool residuals_agree(double claimed, double found, double scale) {
  return agree(claimed, found, scale + residual_round_off / round_off * std::max(std::abs(claimed), std::abs(found)));
}

class RunCheck {
 public:
  RunCheck(const fs::path& folder, std::optional<double> tolerance);
  CheckReport go();

 private:
  void check_summary();
  void check_files();
  void check_frame(const fs::path& file, int step);
  void check_energies(const Frame& frame, const StepRecord& record, const std::string& name);
  void check_stretches(const Frame& frame, const std::string& name);
  void check_last_step();
  bool checkpoint_is_finite();
  void compare_claims(const StepRecord& claimed, const Residuals& found, double objective);
  void check_probes(const StepRecord& claimed, const std::vector<double>& values);
  void find_excess(const Residuals& found);
  void find(std::string text) { report_.findings.push_back(std::move(text)); }
  void cannot(std::string text) { report_.unusable.push_back(std::move(text)); }

  fs::path folder_;
  StoredRun run_;
  std::unique_ptr<Model> model_;
  Stepper stepper_;
  Tolerances tolerances_;
  PositionJudge judge_;
  SurfaceFields fields_;
  Vector coordinates_;  // of a modal body in the last frame
  CheckReport report_;
};

RunCheck::RunCheck(const fs::path& folder, std::optional<double> tolerance)
    : folder_(folder),
      run_(read_stored_run(folder)),
      model_(build_model(run_.scene)),
      stepper_(*model_, time_options(run_.scene)),
      tolerances_(run_.scene.solver.tolerance),
      judge_(*model_, tolerance.value_or(tolerances_.feasibility)),
      fields_(*model_),
      coordinates_(model_->positions) {
  if (tolerance) tolerances_.feasibility = *tolerance;
}

CheckReport RunCheck::go() {
  report_.problem = run_.scene.name;
  report_.subject = folder_.string();
  report_.tolerance = tolerances_.feasibility;
  report_.steps_done = static_cast<int>(run_.steps.size());
  check_summary();
  check_last_step();
  check_files();
  take_worst(report_, 1);
  return std::move(report_);
}

/// summary.json is what the lines of steps.jsonl add up to; and what it says of the run is good.
void RunCheck::check_summary() {
  const RunSummary& claimed = run_.summary;
  RunSummary found;
  found.probes = probes_of(run_.scene);
  for (const StepRecord& record : run_.steps) {
    add_step(found, record);
    if (record.status == Status::solved && !record.residuals.within(run_.scene.solver.tolerance)) {
      find(fmt::format("steps.jsonl: step {} is called solved, but its own residuals are not within tolerance",
                       record.step));
    }
  }
  found.steps_asked = run_.scene.time.steps;
  found.input_hash = run_.scene.hash;
  const bool early = claimed.status == Status::interrupted || claimed.status == Status::time_limit;
  if (early && found.steps_done < found.steps_asked) {
    found.status = claimed.status;
    found.message = claimed.message;
  }
  found.counts.symbolic_analyses = claimed.counts.symbolic_analyses;
  found.counts.matrix_allocations = claimed.counts.matrix_allocations;
  const auto says = nlohmann::json::parse(summary_text(claimed)), adds_up = nlohmann::json::parse(summary_text(found));
  for (const char* key :
       {"input_hash", "status", "message", "steps", "objective", "residuals", "violations", "counts", "probes"}) {
    for (const auto& change : nlohmann::json::diff(says[key], adds_up[key])) {
      const nlohmann::json::json_pointer place(change["path"].get<std::string>());
      find(fmt::format("summary.json: {}{} is {}, but steps.jsonl and problem.json give {}", key,
                       change["path"].get<std::string>(),
                       says[key].contains(place) ? says[key][place].dump() : "missing",
                       adds_up[key].contains(place) ? adds_up[key][place].dump() : "nothing"));
    }
  }
  if (found.status != Status::solved) {
    find(fmt::format("the run is not solved: {}, {}", to_string(found.status), found.message));
  } else if (found.steps_done < found.steps_asked) {
    find(fmt::format("only {} of {} steps are done", found.steps_done, found.steps_asked));
  }
}

void RunCheck::check_files() {
  for (const std::string& name : run_.summary.files) {
    if (!fs::exists(folder_ / name)) cannot(name + ": is listed in summary.json, but not there");
  }
  std::map<int, std::string> frames;
  for (const std::string& name : run_.summary.files) {
    if (name.starts_with("frames/") && fs::exists(folder_ / name)) {
      if (const auto step = frame_number(name)) frames[*step] = name;
    }
  }
  for (const auto& [step, name] : frames) {
    if (step > report_.steps_done) {
      cannot(fmt::format("{}: steps.jsonl has no step {}", name, step));
      continue;
    }
    try {
      check_frame(name, step);
    } catch (const std::bad_alloc&) {
      throw;
    } catch (const std::exception& error) {
      cannot(error.what());
    }
  }
}

void RunCheck::check_frame(const fs::path& file, int step) {
  const Frame frame = read_frame(folder_ / file);
  std::vector<std::string> problems = misfits(frame, *model_);
  if (problems.empty() && frame.triangles != model_->triangles) problems.emplace_back("its faces are in another order");
  for (const std::string& problem : problems) cannot(file.string() + ": " + problem);
  if (!problems.empty()) return;

  Vector velocities = Vector::Zero(frame.positions.size());
  if (!frame.point_fields.empty() && frame.point_fields[0].name == "velocity") {
    velocities = Eigen::Map<const Vector>(frame.point_fields[0].values.data(), velocities.size());
  }
  State state;
  state.step = step;
  state.positions = frame.positions;
  state.velocities = velocities;
  if (model_->modal) {
    // Frames have the vertices of a modal body; what they say is only true where the modes can take them there.
    state.positions = coordinates_ = model_->modal->coordinates(frame.positions, coordinates_);
    state.velocities = model_->modal->rates(coordinates_, velocities);
    const double off = (model_->modal->positions(coordinates_) - frame.positions).lpNorm<Eigen::Infinity>();
    if (!agree(off, 0, 1))
      find(fmt::format("{}: its positions are {:.6g} m from any the modes can reach", file.string(), off));
  }
  state.previous_positions = state.positions;
  state.accelerations = state.previous_velocities = state.auxiliary_accelerations =
      Vector::Zero(state.positions.size());
  stepper_.restore(std::move(state));
  report_.frames.push_back(
      {file.string(), step, stepper_.time(), judge_.constraints(frame.positions, stepper_.time())});
  check_stretches(frame, file.string());
  if (step == 0) {
    if (frame.positions != model_->start()) find(file.string() + ": is not how the problem begins");
    return;
  }
  if (step == run_.checkpoint.state.step &&
      frame.positions != model_->vertex_positions(run_.checkpoint.state.positions)) {
    find(file.string() + ": its positions are not those of checkpoint.bin");
  }
  const StepRecord& record = run_.steps[static_cast<std::size_t>(step - 1)];
  for (const Violation& claimed : record.residuals.violations) {
    for (const Verdict& found : report_.frames.back().verdicts) {
      if (found.constraint != claimed.constraint || residuals_agree(claimed.max, found.max, 1)) continue;
      find(fmt::format("{}: violates {} by {:.6g} ({}), but steps.jsonl says {:.6g}", file.string(), found.constraint,
                       found.max, found.where, claimed.max));
    }
  }
  const std::vector<Penetration> depths = penetrations(*model_, frame.positions);
  for (std::size_t k = 0; k < std::min(depths.size(), record.penetrations.size()); ++k) {
    const Penetration &found = depths[k], &claimed = record.penetrations[k];
    if (agree(claimed.edge, found.edge, 1) && agree(claimed.face, found.face, 1)) continue;
    find(fmt::format("{}: edges and faces are {:.6g} and {:.6g} m inside {}, but steps.jsonl says {:.6g} and {:.6g}",
                     file.string(), found.edge, found.face, found.constraint, claimed.edge, claimed.face));
  }
  check_energies(frame, record, file.string());
}

/// Energies show a vertex that was moved without violating anything.
void RunCheck::check_energies(const Frame& frame, const StepRecord& record, const std::string& name) {
  double scale = 0;
  for (const auto& [energy, value] : record.energies) scale += std::abs(value);
  const NamedNumbers found = stepper_.energies();
  for (const auto& [energy, value] : found) {
    if (energy == "kinetic" && frame.point_fields.empty()) continue;  // OBJ files have no velocities
    const auto claimed = std::find_if(record.energies.begin(), record.energies.end(),
                                      [&name = energy](const auto& known) { return known.first == name; });
    if (claimed != record.energies.end() && agree(claimed->second, value, scale)) continue;
    find(fmt::format("{}: {} of its positions is {:.12g} J, but steps.jsonl says {:.12g} J; one of them was changed",
                     name, energy, value, claimed == record.energies.end() ? std::nan("") : claimed->second));
  }
}

/// VTU files hold the singular values of their triangles, which show a vertex that was moved to no other energy.
void RunCheck::check_stretches(const Frame& frame, const std::string& name) {
  const Frame again = fields_.frame(stepper_.state(), frame.time);
  for (const Field& found : again.cell_fields) {
    if (found.name != "sigma_max" && found.name != "sigma_min") continue;
    for (const Field& stored : frame.cell_fields) {
      if (stored.name != found.name) continue;
      for (std::size_t t = 0; t < found.values.size(); ++t) {
        if (agree(stored.values[t], found.values[t], 1)) continue;
        find(fmt::format("{}: {} of {} is {:.12g} by its positions, but the file says {:.12g}", name, found.name,
                         triangle_name(*model_, static_cast<Index>(t)), found.values[t], stored.values[t]));
        break;
      }
    }
  }
}

bool RunCheck::checkpoint_is_finite() {
  const State& state = run_.checkpoint.state;
  for (Index i = 0; i < state.positions.size(); ++i) {
    if (std::isfinite(state.positions[i])) continue;
    cannot("checkpoint.bin: " + (model_->modal ? "mode " + std::to_string(i + 1) : vertex_name(*model_, i / 3)) +
           " is not finite");
    return false;
  }
  const std::size_t constraints = model_->constraints.size();
  for (std::size_t k = constraints;
       k < std::min(state.warm.multipliers.size(), constraints + model_->equalities.size()); ++k) {
    if (state.warm.multipliers[k].allFinite()) continue;
    cannot(fmt::format("checkpoint.bin: a multiplier of {} is not finite", model_->equalities[k - constraints]->name));
    return false;
  }
  for (std::size_t k = 0; k < state.warm.multipliers.size() && k < constraints; ++k) {
    const Vector& multipliers = state.warm.multipliers[k];
    const Constraint& constraint = *model_->constraints[k];
    for (Index i = 0; i < multipliers.size(); ++i) {
      if (std::isfinite(multipliers[i])) continue;
      cannot(fmt::format("checkpoint.bin: the multiplier of {} at {} is not finite", constraint.name(),
                         constraint.element_name(i / constraint.rows())));
      return false;
    }
  }
  return true;
}

void RunCheck::check_last_step() {
  const State& state = run_.checkpoint.state;
  if (state.step == 0) return find("no step is done");
  if (!run_.checkpoint.before) {
    return cannot("checkpoint.bin: lacks the state before the last step (an earlier version of taut wrote it)");
  }
  try {
    stepper_.restore(state);  // refuses other sizes
    if (!checkpoint_is_finite()) return;
    stepper_.restore(*run_.checkpoint.before);
    const Problem& problem = stepper_.prepare();
    Result result;
    result.x = state.positions;
    result.multipliers = state.warm.multipliers;
    const StepRecord& claimed = run_.steps.at(static_cast<std::size_t>(state.step - 1));
    report_.last_step = RecomputedStep{state.step, claimed.status, residuals(problem, result)};
    if (!problem.equalities.empty())
      report_.last_step->negative_curvatures = negative_curvatures(problem, result, state.warm.penalties);
    Residuals& found = report_.last_step->residuals;
    name_for_people(found, problem, *model_);
    compare_claims(claimed, found, objective(problem, result.x));
    const std::vector<NaturalMode> modes = claimed.status == Status::solved
                                               ? modes_at(run_.scene, *model_, problem, result.x, state.step, 1)
                                               : std::vector<NaturalMode>();
    check_probes(claimed, probe_values(run_.scene, *model_, problem, result.x, modes));
    find_excess(found);
  } catch (const std::invalid_argument& error) {
    cannot(std::string("checkpoint.bin: does not fit the problem: ") + error.what());
  } catch (const std::out_of_range&) {
    cannot(fmt::format("checkpoint.bin: is of step {}, steps.jsonl ends before", state.step));
  }
}

void RunCheck::compare_claims(const StepRecord& claimed, const Residuals& found, double objective) {
  const Residuals& says = claimed.residuals;
  double energy_scale = 0;
  for (const auto& [energy, value] : claimed.energies) energy_scale += std::abs(value);
  const auto compare = [&](const std::string& name, double a, double b, double scale) {
    if (residuals_agree(a, b, scale)) return;
    find(fmt::format("{} of step {} is {:.6g}, but steps.jsonl says {:.6g}", name, claimed.step, b, a));
  };
  compare("stationarity", says.stationarity, found.stationarity, 1);
  compare("force_scale", says.force_scale, found.force_scale, found.force_scale);
  compare("stationarity_unscaled", says.stationarity_unscaled, found.stationarity_unscaled, found.force_scale);
  compare("feasibility", says.feasibility, found.feasibility, 1);
  compare("feasibility_unscaled", says.feasibility_unscaled, found.feasibility_unscaled, 1);
  compare("complementarity", says.complementarity, found.complementarity, 1);
  compare("complementarity_unscaled", says.complementarity_unscaled, found.complementarity_unscaled, found.force_scale);
  if (!agree(claimed.objective, objective, std::max(energy_scale, std::abs(objective)))) {
    find(fmt::format("objective of step {} is {:.12g} J, but steps.jsonl says {:.12g} J", claimed.step, objective,
                     claimed.objective));
  }
  for (const Violation& violation : found.violations) {
    for (const Violation& told : says.violations) {
      if (told.constraint == violation.constraint)
        compare("violation of " + told.constraint, told.max, violation.max, 1);
    }
  }
}

void RunCheck::check_probes(const StepRecord& claimed, const std::vector<double>& values) {
  report_.probes = probes_of(run_.scene);
  for (std::size_t k = 0; k < values.size(); ++k) {
    ProbeValue& probe = report_.probes[k];
    probe.value = values[k];
    const auto told = std::find_if(claimed.probes.begin(), claimed.probes.end(),
                                   [&](const auto& named) { return named.first == probe.name; });
    // Displacements are small differences of positions, reactions of forces.
    if (told == claimed.probes.end()) {
      find(fmt::format("probe {} of step {} is not in steps.jsonl", probe.name, claimed.step));
    } else if (std::isnan(told->second) && std::isnan(probe.value)) {
      continue;  // a frequency before the last step
    } else if (!(std::abs(told->second - probe.value) <= residual_round_off * std::abs(probe.value))) {
      find(fmt::format("probe {} of step {} is {:.12g}, but steps.jsonl says {:.12g}", probe.name, claimed.step,
                       probe.value, told->second));
    }
    if (!probe.within() && claimed.step == run_.scene.time.steps) {
      find(fmt::format("probe {} is {:.6g}, expected {:.6g} within {:.3g} ({})", probe.name, probe.value,
                       probe.expected->value, probe.allowed(), probe.expected->source));
    }
  }
}

void RunCheck::find_excess(const Residuals& found) {
  const int step = report_.last_step->step;
  const auto check = [&](const char* name, double value, double tolerance, const std::string& where) {
    if (value <= tolerance) return;
    find(fmt::format("{} of step {} is {:.3g}, more than {:.3g}{}", name, step, value, tolerance, where));
  };
  std::string worst;
  for (const Violation& violation : found.violations) {
    if (violation.max > 0 && violation.max >= found.feasibility_unscaled) {
      worst = " (" + violation.constraint + ", " + violation.where + ")";
    }
  }
  check("stationarity", found.stationarity, tolerances_.stationarity, " (" + found.worst_node + ")");
  check("feasibility", found.feasibility, tolerances_.feasibility, worst);
  check("complementarity", found.complementarity, tolerances_.complementarity, "");
  if (!found.finite) find(fmt::format("residuals of step {} are not finite", step));
}

}  // namespace

CheckReport check_run(const fs::path& folder, std::optional<double> tolerance) {
  return RunCheck(folder, tolerance).go();
}

}  // namespace taut
