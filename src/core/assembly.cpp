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

/// Elements that are evaluated together as a Real: a block is one element, or a quad of them (pack.h).
template <class Real>
constexpr int lanes = sizeof(Real) / sizeof(double);

double evaluate(const Energy& energy, Index element, const double* x, double* gradient, double* hessian,
                Curvature curvature) {
  return energy.evaluate(element, x, gradient, hessian, curvature);
}
Pack evaluate(const Energy& energy, Index quad, const Pack* x, Pack* gradient, Pack* hessian, Curvature curvature) {
  return energy.evaluate_four(quad, x, gradient, hessian, curvature);
}

double* doubles(double* reals) { return reals; }
double* doubles(Pack* reals) { return reinterpret_cast<double*>(reals); }
const double* doubles(const double* reals) { return reals; }
const double* doubles(const Pack* reals) { return reinterpret_cast<const double*>(reals); }

/// As Energy::evaluate, of the sum of the term's energies.
template <class Real>
Real evaluate(const AssemblyTerm& term, Index block, const Real* x, Real* gradient, Real* hessian,
              Curvature curvature) {
  const auto& energies = term.energies;
  Real value = evaluate(*energies.front(), block, x, gradient, hessian, curvature);
  if (energies.size() == 1) return value;
  const int width = term.stencils().width();
  Scratch<max_stencil_width, Real> more_gradient(width);
  Scratch<max_stencil_width * max_stencil_width, Real> more_hessian(width * width);
  for (std::size_t k = 1; k < energies.size(); ++k) {
    value += evaluate(*energies[k], block, x, gradient ? more_gradient.data() : nullptr,
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

/// Calls visit(element, lane) for each element of a block.
template <class Real, class Visit>
void for_lanes(const AssemblyTerm& term, Index block, const Visit& visit) {
  for (int lane = 0; lane < lanes<Real>; ++lane) {
    const Index element = block * lanes<Real> + lane;
    if (element < term.stencils().count()) visit(element, lane);
  }
}

/// Calls visit(block) for each block of the term that `thread` of `threads` has to see, in ascending order.
template <class Real, class Visit>
void for_blocks(const AssemblyTerm& term, int thread, int threads, const Visit& visit) {
  if (threads == 1) {
    const Index count = term.stencils().count(), blocks = lanes<Real> == 1 ? count : quads(count);
    for (Index block = 0; block < blocks; ++block) visit(block);
  } else {
    const auto& mine = lanes<Real> == 1 ? term.elements : term.quads;
    for (const int block : mine[static_cast<std::size_t>(thread)]) visit(Index{block});
  }
}

/// task(double()) or task(Pack()): how the elements of a term are evaluated.
template <class Task>
void one_or_four(bool four, const Task& task) {
  if (four) {
    task(Pack());
  } else {
    task(double());
  }
}

}  // namespace

struct Assembly::Data : AssemblyPattern {
  using AssemblyPattern::AssemblyPattern;

  std::vector<double> weak_values;  // of the matrix, from the terms that couple weakly, when last evaluated

  double sum_of_values() const;
  template <class Real>
  void mask(const AssemblyTerm& term, Index element, double* hessian) const;
  template <int B>
  void add_gradient(int thread, const Vector& x, Vector& gradient) const;
  template <int B>
  void add_hessian(int thread, const Vector& x, Curvature curvature, Vector* gradient, bool hold_weak);
  template <int B, class Real>
  void add_term(const AssemblyTerm& term, int thread, const Vector& x, Curvature curvature, bool curved,
                Vector* gradient);
  template <int B, class Real>
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
      one_or_four(term.takes_four(Curvature::positive_semidefinite), [&]<class Real>(Real) {
        Scratch<max_stencil_width, Real> local(stencils.width());
        for_blocks<Real>(term, thread, d.threads, [&](Index block) {
          stencils.gather(block, x, local.data());
          Real* none = nullptr;
          const Real value = evaluate(term, block, local.data(), none, none, Curvature::positive_semidefinite);
          for_lanes<Real>(term, block, [&](Index element, int lane) {
            if (term.primary[element] == thread) term.values[element] = doubles(&value)[lane];
          });
        });
      });
    }
  });
  return d.sum_of_values();
}

template <int B>
void Assembly::Data::add_gradient(int thread, const Vector& x, Vector& gradient) const {
  for (const AssemblyTerm& term : terms) {
    const Stencils& stencils = term.stencils();
    one_or_four(term.takes_four(Curvature::positive_semidefinite), [&]<class Real>(Real) {
      Scratch<max_stencil_width, Real> local(stencils.width()), part(stencils.width());
      for_blocks<Real>(term, thread, threads, [&](Index block) {
        stencils.gather(block, x, local.data());
        Real* none = nullptr;
        const Real value = evaluate(term, block, local.data(), part.data(), none, Curvature::positive_semidefinite);
        for_lanes<Real>(term, block, [&](Index element, int lane) {
          if (term.primary[element] == thread) term.values[element] = doubles(&value)[lane];
          add_local_gradient<B, Real>(term, element, thread, doubles(part.data()) + lane, gradient);
        });
      });
    });
  }
}

double Assembly::gradient(const Vector& x, Vector& gradient) const {
  const Data& d = *data_;
  gradient.setZero(d.size);
  parallel_for(d.threads, [&](int thread) {
    if (d.group_size == 3) {
      d.add_gradient<3>(thread, x, gradient);
    } else {
      d.add_gradient<1>(thread, x, gradient);
    }
  });
  d.clear_fixed(gradient);
  return d.sum_of_values();
}

/// Adds those entries of an element's gradient, one lane of Reals, that `thread` owns: with one thread all of them,
/// also those of fixed variables, which clear_fixed() clears.
template <int B, class Real>
void Assembly::Data::add_local_gradient(const AssemblyTerm& term, Index element, int thread, const double* part,
                                        Vector& gradient) const {
  const int* variables = term.stencils()[element];
  for (int k = 0; k < term.groups; ++k) {
    if (threads > 1) {
      const int p = position[variables[k * B] / B];
      if (p < range[thread] || p >= range[thread + 1]) continue;
    }
    for (int i = k * B; i < (k + 1) * B; ++i) gradient[variables[i]] += part[i * lanes<Real>];
  }
}

void Assembly::Data::clear_fixed(Vector& gradient) const {
  for (Index i = 0; i < gradient.size(); ++i) {
    if (fixed[static_cast<std::size_t>(i)]) gradient[i] = 0;
  }
}

/// Clears the rows and columns of fixed variables in a local Hessian, one lane of Reals.
template <class Real>
void Assembly::Data::mask(const AssemblyTerm& term, Index element, double* hessian) const {
  const Stencils& stencils = term.stencils();
  const int width = stencils.width();
  for (int i = 0; i < width; ++i) {
    if (!fixed[stencils[element][i]]) continue;
    for (int j = 0; j < width; ++j) hessian[(i + j * width) * lanes<Real>] = hessian[(j + i * width) * lanes<Real>] = 0;
  }
}

template <int B>
void Assembly::Data::add_hessian(int thread, const Vector& x, Curvature curvature, Vector* total, bool hold_weak) {
  const int first = matrix.outerIndexPtr()[range[thread] * B], last = matrix.outerIndexPtr()[range[thread + 1] * B];
  double *values = matrix.valuePtr(), *held = weak_values.data();
  if (hold_weak) {
    std::copy(held + first, held + last, values + first);
  } else {
    std::fill(values + first, values + last, 0.0);
  }
  const auto add = [&](const AssemblyTerm& term, bool curved) {
    if (!curved && !total) return;
    one_or_four(term.takes_four(curvature),
                [&]<class Real>(Real) { add_term<B, Real>(term, thread, x, curvature, curved, total); });
  };
  const std::size_t weak = weak_terms;
  for (std::size_t k = 0; k < weak; ++k) add(terms[k], terms[k].has_curvature() && !hold_weak);
  if (weak > 0 && !hold_weak) std::copy(values + first, values + last, held + first);
  for (std::size_t k = weak; k < terms.size(); ++k) add(terms[k], terms[k].has_curvature());
}

template <int B, class Real>
void Assembly::Data::add_term(const AssemblyTerm& term, int thread, const Vector& x, Curvature curvature, bool curved,
                              Vector* total) {
  double* values = matrix.valuePtr();
  const int first = matrix.outerIndexPtr()[range[thread] * B], last = matrix.outerIndexPtr()[range[thread + 1] * B];
  const Stencils& stencils = term.stencils();
  const int width = stencils.width(), blocks = term.groups * (term.groups + 1) / 2;
  constexpr int step = lanes<Real>;
  Scratch<max_stencil_width, Real> local(width), gradient(width);
  Scratch<max_stencil_width * max_stencil_width, Real> hessian(width * width);
  for_blocks<Real>(term, thread, threads, [&](Index block) {
    stencils.gather(block, x, local.data());
    evaluate(term, block, local.data(), gradient.data(), curved ? hessian.data() : nullptr, curvature);
    for_lanes<Real>(term, block, [&](Index element, int lane) {
      if (total) add_local_gradient<B, Real>(term, element, thread, doubles(gradient.data()) + lane, *total);
      if (!curved) return;
      double* entries = doubles(hessian.data()) + lane;
      if (term.masked[element]) mask<Real>(term, element, entries);
      const BlockSlot* slot = term.slots.data() + element * blocks;
      for (int k = 0; k < blocks; ++k, ++slot) {
        if (slot->start < first || slot->start >= last) continue;
        for (int c = 0; c < B; ++c) {
          // Not the same memory, which the compiler cannot know and has to before it may add two rows at once.
          double* __restrict__ target = values + slot->start + c * slot->stride;
          const double* __restrict__ source = entries + ((slot->column + c) * width + slot->row) * step;
          for (int r = 0; r < B; ++r) target[r] += source[r * step];
        }
      }
    });
  });
}

void Assembly::clear_fixed(Vector& gradient) const { data_->clear_fixed(gradient); }

void Assembly::hessian(const Vector& x, Curvature curvature, Vector* gradient, bool hold_weak) {
  Data& d = *data_;
  d.weak_values.resize(d.weak_terms > 0 ? static_cast<std::size_t>(d.matrix.nonZeros()) : 0);
  if (gradient) gradient->setZero(d.size);
  parallel_for(d.threads, [&](int thread) {
    if (d.group_size == 3) {
      d.add_hessian<3>(thread, x, curvature, gradient, hold_weak);
    } else {
      d.add_hessian<1>(thread, x, curvature, gradient, hold_weak);
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
