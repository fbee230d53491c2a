#include "core/problem.h"

#include <atomic>
#include <stdexcept>

namespace taut {
namespace {

void check_stencils(const std::string& owner, const Stencils& stencils, Index size) {
  for (Index element = 0; element < stencils.count(); ++element) {
    for (int i = 0; i < stencils.width(); ++i) {
      const int variable = stencils[element][i];
      if (variable < 0 || variable >= size) {
        throw std::invalid_argument(owner + ": element " + std::to_string(element) + " uses variable " +
                                    std::to_string(variable) + ", expected 0 to " + std::to_string(size - 1));
      }
    }
  }
}

}  // namespace

void Problem::validate() const {
  for (const Energy* energy : energies) check_stencils(energy->name(), energy->stencils(), size());
  for (const Constraint* constraint : constraints) {
    check_stencils(constraint->name(), constraint->stencils(), size());
    if (constraint->rows() > max_rows || constraint->rows() != constraint->set().dimension()) {
      throw std::invalid_argument(constraint->name() + ": " + std::to_string(constraint->rows()) +
                                  " rows, but its set has dimension " + std::to_string(constraint->set().dimension()) +
                                  " (at most " + std::to_string(max_rows) + ")");
    }
  }
  for (const LinearEqualities* equal : equalities) {
    const auto expect = [&](const char* what, Index found, Index expected) {
      if (found == expected) return;
      throw std::invalid_argument(equal->name + ": " + what + " is " + std::to_string(found) + ", expected " +
                                  std::to_string(expected));
    };
    expect("number of variables", equal->rows.cols(), size());
    expect("number of values", equal->values.size(), equal->rows.rows());
    if (equal->null_space.cols() > 0) expect("rows of the null space", equal->null_space.rows(), size());
  }
  if (fixed_values.size() != static_cast<Index>(fixed_variables.size())) {
    throw std::invalid_argument("Problem: " + std::to_string(fixed_variables.size()) + " fixed variables but " +
                                std::to_string(fixed_values.size()) + " values");
  }
  for (std::size_t i = 0; i < fixed_variables.size(); ++i) {
    if (fixed_variables[i] < 0 || fixed_variables[i] >= size() ||
        (i > 0 && fixed_variables[i] <= fixed_variables[i - 1])) {
      throw std::invalid_argument("Problem: fixed variables must ascend within 0 to " + std::to_string(size() - 1) +
                                  ", found " + std::to_string(fixed_variables[i]) + " at place " + std::to_string(i));
    }
  }
  if (node_size < 1 || size() % node_size != 0) {
    throw std::invalid_argument("Problem: node_size " + std::to_string(node_size) + " does not divide " +
                                std::to_string(size()));
  }
}

std::uint64_t new_topology() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

}  // namespace taut
