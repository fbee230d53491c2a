#include "core/result.h"

#include <array>
#include <stdexcept>
#include <utility>

namespace taut {
namespace {

constexpr std::array<std::pair<Status, std::string_view>, 9> names{{
    {Status::solved, "solved"},
    {Status::infeasible, "infeasible"},
    {Status::unbounded, "unbounded"},
    {Status::stalled, "stalled"},
    {Status::limit_point, "limit_point"},
    {Status::iteration_limit, "iteration_limit"},
    {Status::time_limit, "time_limit"},
    {Status::not_finite, "not_finite"},
    {Status::interrupted, "interrupted"},
}};

}  // namespace

std::string_view to_string(Status status) {
  for (const auto& [value, name] : names) {
    if (value == status) return name;
  }
  throw std::invalid_argument("to_string: not a Status");
}

Status status_from_string(std::string_view text) {
  for (const auto& [value, name] : names) {
    if (name == text) return value;
  }
  throw std::invalid_argument("status_from_string: '" + std::string(text) + "' is not a status");
}

Counts& Counts::operator+=(const Counts& other) {
  outer += other.outer;
  linear_solves += other.linear_solves;
  factorizations += other.factorizations;
  pivoted_factorizations += other.pivoted_factorizations;
  inner_iterations += other.inner_iterations;
  screened += other.screened;
  screening_failures += other.screening_failures;
  symbolic_analyses += other.symbolic_analyses;
  matrix_allocations += other.matrix_allocations;
  function_evaluations += other.function_evaluations;
  factor_flops += other.factor_flops;
  return *this;
}

Timings& Timings::operator+=(const Timings& other) {
  total += other.total;
  assembly += other.assembly;
  analysis += other.analysis;
  factorization += other.factorization;
  solve += other.solve;
  return *this;
}

}  // namespace taut
