#include "problems/solver_from_json.h"

#include <nlohmann/json.hpp>

#include "problems/json_reader.h"

namespace taut {
namespace {

using namespace scene;

/// For JsonReader's choices.
class SolverReader : public JsonReader {
 public:
  static scene::Solver read(const Json& json) {
    scene::Solver result;
    result.method = choose<SolverMethod>(json["method"], {{"augmented_lagrangian", SolverMethod::augmented_lagrangian},
                                                          {"null_space", SolverMethod::null_space},
                                                          {"alternating", SolverMethod::alternating},
                                                          {"ipopt", SolverMethod::ipopt},
                                                          {"nlopt", SolverMethod::nlopt}});
    const Json& tolerance = json["tolerance"];
    result.tolerance = {tolerance["stationarity"], tolerance["feasibility"], tolerance["complementarity"]};
    result.central_path = json["central_path"];
    result.penalty = json["penalty"];
    result.penalty_growth = json["penalty_growth"];
    result.fixed_penalty = json["fixed_penalty"];
    result.penalised_pins = json["pins"] == "penalised";
    result.warm_multipliers = json["warm_multipliers"];
    result.max_outer = json["max_outer"];
    result.max_newton = json["max_newton"];
    result.inner_tolerance_factor = json["inner_tolerance_factor"];
    result.longest_step = json["longest_step"];
    result.newton_finish = json["newton_finish"];
    result.screening = json["screening"];
    result.starts = json["starts"];
    result.conjugate_gradients = json["null_space"] == "conjugate_gradients";
    result.equalities = choose<EqualityForm>(
        json["equalities"], {{"quasi_definite", EqualityForm::quasi_definite}, {"penalised", EqualityForm::penalised}});
    result.ipopt = {json["ipopt"]["max_iterations"], json["ipopt"]["warm_start"]};
    result.nlopt.algorithm =
        choose<NloptAlgorithm>(json["nlopt"]["algorithm"], {{"slsqp", NloptAlgorithm::slsqp},
                                                            {"auglag_slsqp", NloptAlgorithm::auglag_slsqp},
                                                            {"auglag_lbfgs", NloptAlgorithm::auglag_lbfgs},
                                                            {"auglag_ccsaq", NloptAlgorithm::auglag_ccsaq},
                                                            {"auglag_tnewton", NloptAlgorithm::auglag_tnewton}});
    result.nlopt.max_evaluations = json["nlopt"]["max_evaluations"];
    result.on_failure =
        choose<OnFailure>(json["on_failure"], {{"stop", OnFailure::stop}, {"continue", OnFailure::proceed}});
    return result;
  }
};

}  // namespace

scene::Solver solver_from_json(const nlohmann::json& section) { return SolverReader::read(section); }

}  // namespace taut
