#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace taut {

/// A heat map of stress_report() as a self-contained SVG: a row per method, a column per value of the knob, colour and
/// letter by outcome, the cell's text as its tooltip.
std::string heat_map_svg(const nlohmann::json& heat_map);

}  // namespace taut
