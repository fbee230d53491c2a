#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "study/profiles.h"

namespace taut {

/// A chart of html_report.h with a step function for each solver from `first` to where the last of all ends.
nlohmann::json profile_chart(const std::string& id, const std::string& title, const std::string& x_label, double first,
                             const std::vector<std::string>& solvers, const std::vector<Profile>& profiles);

}  // namespace taut
