#include "study/profiles.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace taut {
namespace {

void check(const Matrix& costs) {
  for (Index row = 0; row < costs.rows(); ++row) {
    for (Index column = 0; column < costs.cols(); ++column) {
      if (!(costs(row, column) > 0))
        throw std::invalid_argument("profiles: expected positive costs, got " + std::to_string(costs(row, column)));
    }
  }
}

/// The share of the values that are at most x; infinite ones never are.
Profile distribution(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  Profile profile;
  for (std::size_t k = 0; k < values.size() && std::isfinite(values[k]); ++k) {
    const double share = static_cast<double>(k + 1) / static_cast<double>(values.size());
    if (!profile.x.empty() && profile.x.back() == values[k]) {
      profile.share.back() = share;
    } else {
      profile.x.push_back(values[k]);
      profile.share.push_back(share);
    }
  }
  return profile;
}

}  // namespace

double Profile::operator()(double at) const {
  const auto after = std::upper_bound(x.begin(), x.end(), at);
  return after == x.begin() ? 0 : share[static_cast<std::size_t>(after - x.begin()) - 1];
}

std::vector<Profile> data_profiles(const Matrix& costs) {
  check(costs);
  std::vector<Profile> profiles;
  for (Index solver = 0; solver < costs.cols(); ++solver) {
    const Vector column = costs.col(solver);
    profiles.push_back(distribution({column.begin(), column.end()}));
  }
  return profiles;
}

std::vector<Profile> performance_profiles(const Matrix& costs) {
  check(costs);
  Matrix ratios = costs;
  for (Index instance = 0; instance < costs.rows(); ++instance) {
    const double best = costs.row(instance).minCoeff();
    if (std::isfinite(best)) ratios.row(instance) /= best;
  }
  return data_profiles(ratios);
}

double shifted_geometric_mean(const std::vector<double>& values, double shift) {
  if (values.empty()) throw std::invalid_argument("shifted_geometric_mean: expected values, got none");
  double sum = 0;
  for (const double value : values) {
    if (!(value + shift > 0))
      throw std::invalid_argument("shifted_geometric_mean: expected values above -shift, got " + std::to_string(value));
    sum += std::log(value + shift);
  }
  return std::exp(sum / static_cast<double>(values.size())) - shift;
}

}  // namespace taut
