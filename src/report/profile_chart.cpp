#include "report/profile_chart.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace taut {

nlohmann::json profile_chart(const std::string& id, const std::string& title, const std::string& x_label, double first,
                             const std::vector<std::string>& solvers, const std::vector<Profile>& profiles) {
  using Json = nlohmann::json;
  double last = first;
  for (const Profile& profile : profiles) {
    if (!profile.x.empty()) last = std::max(last, profile.x.back());
  }
  Json series = Json::array();
  for (std::size_t solver = 0; solver < profiles.size(); ++solver) {
    const Profile& profile = profiles[solver];
    Json points = Json::array();
    const auto add = [&points](double x, double y) { points.push_back({{"x", x}, {"y", y}}); };
    double share = 0;
    add(first, profile(first));
    for (std::size_t k = 0; k < profile.x.size(); ++k) {
      if (profile.x[k] > first) {
        add(profile.x[k], share);
        add(profile.x[k], profile.share[k]);
      }
      share = profile.share[k];
    }
    add(1.1 * last, share);
    series.push_back({{"name", solvers[solver]}, {"line", true}, {"points", points}});
  }
  return {{"id", id},
          {"title", title},
          {"x", {{"label", x_label}, {"log", true}}},
          {"y", {{"label", "share of instances solved correctly"}, {"log", false}}},
          {"series", series}};
}

}  // namespace taut
