#pragma once

#include <memory>
#include <string>

#include "problems/build.h"

namespace taut {

/// Solves, moves a vertex, and says solved.
class LyingSolver final : public Solver {
 public:
  explicit LyingSolver(const Scene& scene) : honest_(build_solver(scene, 1)) {}
  std::string name() const override { return "liar"; }
  Result solve(const Problem& problem, const WarmStart& warm, const Budget& budget) override {
    Result result = honest_->solve(problem, warm, budget);
    result.x[2] += 0.01;
    return result;
  }

 private:
  std::unique_ptr<Solver> honest_;
};

}  // namespace taut
