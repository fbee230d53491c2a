#include "core/assembly.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/assembly_pattern.h"
#include "core/parallel.h"
#include "core/scratch.h"

namespace taut {
namespace {

/// As Energy::evaluate, of the sum of the term's energies.
double evaluate(const AssemblyTerm& term, Index element, const double* x, double* gradient, double* hessian,
                Curvature curvature) {
  const auto& energies = term.energies;
  double value = energies.front()->evaluate(element, x, gradient, hessian, curvature);
  if (energies.size() == 1) return value;
  const int width = term.stencils().width();
  Scratch<max_stencil_width> more_gradient(width);
  Scratch<max_stencil_width * max_stencil_width> more_hessian(width * width);
  for (std::size_t k = 1; k < energies.size(); ++k) {
    value += energies[k]->evaluate(element, x, gradient ? more_gradient.data() : nullptr,
                                   hessian ? more_hessian.data() : nullptr, curvature);
    if (gradient) {
      for (int i = 0; i < width; ++i) gradient[i] += more_gradient[i];
    }
    if (hessian) {
      for (int i = 0; i < width * width; ++i) hessian[i] += more_hessian[i];
    }
  }
  return value;
}

/// Calls visit(element) for each element of the term that `thread` of `threads` has to see, in ascending order.
template <class Visit>
void for_elements(const AssemblyTerm& term, int thread, int threads, const Visit& visit) {
  if (threads == 1) {
    for (Index element = 0; element < term.stencils().count(); ++element) visit(element);
  } else {
    for (int element : term.elements[static_cast<std::size_t>(thread)]) visit(Index{element});
  }
}

}  // namespace

struct Assembly::Data : AssemblyPattern {
  using AssemblyPattern::AssemblyPattern;

  double sum_of_values() const;
  void mask(const AssemblyTerm& term, Index element, double* hessian) const;
  template <int B>
  void add_hessian(int thread, const Vector& x, Curvature curvature, Vector* gradient);
  void add_local_gradient(const AssemblyTerm& term, Index element, int thread, const double* part,
                          Vector& gradient) const;
  void clear_fixed(Vector& gradient) const;
};

Assembly::Assembly(Index size, const std::vector<const Energy*>& energies, const std::vector<int>& fixed, int threads)
    : data_(std::make_unique<Data>(size, energies, fixed, threads)) {}

Assembly::~Assembly() = default;
Assembly::Assembly(Assembly&&) noexcept = default;
Assembly& Assembly::operator=(Assembly&&) noexcept = default;

const GroupGraph& Assembly::graph() const { return data_->graph; }
GroupGraph Assembly::strong_graph() const { return data_->build_graph(false); }

void Assembly::set_order(const std::vector<int>& order) { data_->set_order(order); }

std::size_t Assembly::memory_bytes() const { return data_->memory_bytes(); }

double Assembly::Data::sum_of_values() const {
  double sum = 0;
  for (const AssemblyTerm& term : terms) sum += std::accumulate(term.values.begin(), term.values.end(), 0.0);
  return sum;
}

double Assembly::value(const Vector& x) const {
  const Data& d = *data_;
  parallel_for(d.threads, [&](int thread) {
    for (const AssemblyTerm& term : d.terms) {
      const Stencils& stencils = term.stencils();
      Scratch<max_stencil_width> local(stencils.width());
      const Index first = stencils.count() * thread / d.threads, last = stencils.count() * (thread + 1) / d.threads;
      for (Index element = first; element < last; ++element) {
        stencils.gather(element, x, local.data());
        term.values[element] = evaluate(term, element, local.data(), nullptr, nullptr, Curvature::exact);
      }
    }
  });
  return d.sum_of_values();
}

double Assembly::gradient(const Vector& x, Vector& gradient) const {
  const Data& d = *data_;
  gradient.setZero(d.size);
  parallel_for(d.threads, [&](int thread) {
    for (const AssemblyTerm& term : d.terms) {
      const Stencils& stencils = term.stencils();
      Scratch<max_stencil_width> local(stencils.width()), part(stencils.width());
      for_elements(term, thread, d.threads, [&](Index element) {
        stencils.gather(element, x, local.data());
        const double value = evaluate(term, element, local.data(), part.data(), nullptr, Curvature::exact);
        if (term.primary[element] == thread) term.values[element] = value;
        d.add_local_gradient(term, element, thread, part.data(), gradient);
      });
    }
  });
  d.clear_fixed(gradient);
  return d.sum_of_values();
}

/// Adds those entries of an element's gradient that `thread` owns.
void Assembly::Data::add_local_gradient(const AssemblyTerm& term, Index element, int thread, const double* part,
                                        Vector& gradient) const {
  const int* variables = term.stencils()[element];
  for (int k = 0; k < term.groups; ++k) {
    const int p = position[variables[k * group_size] / group_size];
    if (p < range[thread] || p >= range[thread + 1]) continue;
    for (int i = k * group_size; i < (k + 1) * group_size; ++i) gradient[variables[i]] += part[i];
  }
}

void Assembly::Data::clear_fixed(Vector& gradient) const {
  for (int group : partly_fixed) {
    for (int i = group * group_size; i < (group + 1) * group_size; ++i) {
      if (fixed[i]) gradient[i] = 0;
    }
  }
}

/// Clears the rows and columns of fixed variables in a local Hessian.
void Assembly::Data::mask(const AssemblyTerm& term, Index element, double* hessian) const {
  const Stencils& stencils = term.stencils();
  const int width = stencils.width();
  for (int i = 0; i < width; ++i) {
    if (!fixed[stencils[element][i]]) continue;
    for (int j = 0; j < width; ++j) hessian[i + j * width] = hessian[j + i * width] = 0;
  }
}

template <int B>
void Assembly::Data::add_hessian(int thread, const Vector& x, Curvature curvature, Vector* total) {
  double* values = matrix.valuePtr();
  const int first = matrix.outerIndexPtr()[range[thread] * B], last = matrix.outerIndexPtr()[range[thread + 1] * B];
  std::fill(values + first, values + last, 0.0);
  for (const AssemblyTerm& term : terms) {
    const bool curved = term.has_curvature();
    if (!curved && !total) continue;
    const Stencils& stencils = term.stencils();
    const int width = stencils.width(), blocks = term.groups * (term.groups + 1) / 2;
    Scratch<max_stencil_width> local(width), gradient(width);
    Scratch<max_stencil_width * max_stencil_width> hessian(width * width);
    for_elements(term, thread, threads, [&](Index element) {
      stencils.gather(element, x, local.data());
      evaluate(term, element, local.data(), gradient.data(), curved ? hessian.data() : nullptr, curvature);
      if (total) add_local_gradient(term, element, thread, gradient.data(), *total);
      if (!curved) return;
      if (term.masked[element]) mask(term, element, hessian.data());
      const BlockSlot* slot = term.slots.data() + element * blocks;
      for (int k = 0; k < blocks; ++k, ++slot) {
        if (slot->start < first || slot->start >= last) continue;
        for (int c = 0; c < B; ++c) {
          // Not the same memory, which the compiler cannot know and has to before it may add two rows at once.
          double* __restrict__ target = values + slot->start + c * slot->stride;
          const double* __restrict__ source = hessian.data() + (slot->column + c) * width + slot->row;
          for (int r = 0; r < B; ++r) target[r] += source[r];
        }
      }
    });
  }
}

void Assembly::clear_fixed(Vector& gradient) const {
  for (Index i = 0; i < gradient.size(); ++i) {
    if (data_->fixed[static_cast<std::size_t>(i)]) gradient[i] = 0;
  }
}

void Assembly::hessian(const Vector& x, Curvature curvature, Vector* gradient) {
  Data& d = *data_;
  if (gradient) gradient->setZero(d.size);
  parallel_for(d.threads, [&](int thread) {
    if (d.group_size == 3) {
      d.add_hessian<3>(thread, x, curvature, gradient);
    } else {
      d.add_hessian<1>(thread, x, curvature, gradient);
    }
  });
  for (int slot : d.unit_diagonal) d.matrix.valuePtr()[slot] = 1.0;
  if (gradient) d.clear_fixed(*gradient);
}

const SparseMatrix& Assembly::matrix() const { return data_->matrix; }

double Assembly::largest_step(const Vector& x, const Vector& dx) const {
  const Data& d = *data_;
  double largest = std::numeric_limits<double>::infinity();
  for (const AssemblyTerm& term : d.terms) {
    for (const Energy* energy : term.energies) {
      if (!energy->guards_steps()) continue;
      const Stencils& stencils = energy->stencils();
      Scratch<max_stencil_width> local(stencils.width()), step(stencils.width());
      for (Index element = 0; element < stencils.count(); ++element) {
        stencils.gather(element, x, local.data());
        stencils.gather(element, dx, step.data());
        largest = std::min(largest, energy->largest_step(element, local.data(), step.data()));
      }
    }
  }
  return largest;
}

Index Assembly::size() const { return data_->size; }
Index Assembly::ordered_size() const { return data_->matrix.rows(); }

void Assembly::to_ordered(const Vector& full, Vector& ordered) const {
  const Data& d = *data_;
  ordered.resize(ordered_size());
  for (std::size_t p = 0; p < d.order.size(); ++p) {
    for (int i = 0; i < d.group_size; ++i)
      ordered[static_cast<Index>(p) * d.group_size + i] = full[d.order[p] * d.group_size + i];
  }
}

void Assembly::from_ordered(const Vector& ordered, Vector& full) const {
  const Data& d = *data_;
  full.setZero(d.size);
  for (std::size_t p = 0; p < d.order.size(); ++p) {
    for (int i = 0; i < d.group_size; ++i) {
      const int variable = d.order[p] * d.group_size + i;
      if (!d.fixed[variable]) full[variable] = ordered[static_cast<Index>(p) * d.group_size + i];
    }
  }
}

}  // namespace taut
