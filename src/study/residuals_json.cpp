#include "study/residuals_json.h"

#include <limits>
#include <nlohmann/json.hpp>

namespace taut {

using Json = nlohmann::ordered_json;

double number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json residuals_json(const Residuals& r) {
  return {{"stationarity", r.stationarity},       {"stationarity_unscaled", r.stationarity_unscaled},
          {"force_scale", r.force_scale},         {"worst_node", r.worst_node},
          {"feasibility", r.feasibility},         {"feasibility_unscaled", r.feasibility_unscaled},
          {"complementarity", r.complementarity}, {"complementarity_unscaled", r.complementarity_unscaled}};
}

Residuals read_residuals(const Json& json) {
  Residuals r;
  r.stationarity = number(json.at("stationarity"));
  r.stationarity_unscaled = number(json.at("stationarity_unscaled"));
  r.force_scale = number(json.at("force_scale"));
  r.worst_node = json.at("worst_node");
  r.feasibility = number(json.at("feasibility"));
  r.feasibility_unscaled = number(json.at("feasibility_unscaled"));
  r.complementarity = number(json.at("complementarity"));
  r.complementarity_unscaled = number(json.at("complementarity_unscaled"));
  return r;
}

Counts read_counts(const Json& json) {
  return {json.at("outer"),
          json.at("linear_solves"),
          json.at("factorizations"),
          json.value("pivoted_factorizations", 0L),
          json.value("inner_iterations", 0L),
          json.at("symbolic_analyses"),
          json.at("matrix_allocations"),
          json.at("function_evaluations"),
          json.value("screened", 0L),
          json.value("screening_failures", 0L),
          json.value("factor_flops", 0.0)};
}

}  // namespace taut
