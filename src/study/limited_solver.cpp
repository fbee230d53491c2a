#include "study/limited_solver.h"

#include <fmt/format.h>

#include <atomic>

namespace taut {

std::string LimitedSolver::message() const {
  return fmt::format("the {} linear solves that the run may take are used up", allowed_);
}

Result LimitedSolver::solve(const Problem& problem, const WarmStart& warm, const Budget& budget) {
  std::atomic<bool> stop = used_up();
  solver_.observer = [&](const Iterate& iterate) {
    if (observer) observer(iterate);
    if (budget.interrupted() || used_ + iterate.counts.linear_solves >= allowed_) stop = true;
  };
  Result result = solver_.solve(problem, warm, {budget.deadline, &stop});
  solver_.observer = nullptr;
  used_ += result.counts.linear_solves;
  if (result.status == Status::interrupted && !budget.interrupted()) {
    result.status = Status::iteration_limit;
    result.message = message();
  }
  return result;
}

}  // namespace taut
