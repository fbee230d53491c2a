#include "linalg/cholesky.h"

#include <cholmod.h>
#include <dlfcn.h>
#include <metis.h>
#include <omp.h>

#include <cstring>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>

#include "linalg/single_precision_factor.h"
#include "linalg/subtree_cholesky.h"

extern "C" void openblas_set_num_threads(int);

namespace {
/// True while CHOLMOD works for this thread.
thread_local bool serial_regions = false;
}  // namespace

/// Takes the place of libgomp's entry to a parallel region. libgomp makes and frees a team for each region even where
/// it has one thread, and CHOLMOD opens hundreds of small ones per factorisation: a fifth of the time at 3000 unknowns.
/// For CHOLMOD a region is a plain call, for everybody else what it was (docs/decisions/0010).
extern "C" void GOMP_parallel(void (*body)(void*), void* data, unsigned threads, unsigned flags) {
  using Parallel = void (*)(void (*)(void*), void*, unsigned, unsigned);
  static const auto original = reinterpret_cast<Parallel>(dlsym(RTLD_NEXT, "GOMP_parallel"));
  if (serial_regions || !original) {
    body(data);
  } else {
    original(body, data, threads, flags);
  }
}

namespace taut {
namespace {

/// From this many unknowns on a factorisation has subtrees that are worth a second thread.
constexpr Index threads_from = 40000;

struct Common {
  cholmod_common common;
  Common() {
    cholmod_start(&common);
    common.print = 0;
    common.nmethods = 1;
#ifdef TAUT_WITH_SUPERNODAL
    common.supernodal = CHOLMOD_SUPERNODAL;
#else
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 1;
#endif
  }
  ~Common() { cholmod_finish(&common); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
};

/// CHOLMOD starts OpenMP threads of its own whatever the environment says, which costs a factor 2 to 4 on small
/// matrices.
void quiet_openmp() {
  static std::once_flag once;
  std::call_once(once, [] { omp_set_max_active_levels(0); });
}

/// Regions of this thread are plain calls while one of these lives.
struct SerialRegions {
  SerialRegions() { serial_regions = true; }
  ~SerialRegions() { serial_regions = false; }
  SerialRegions(const SerialRegions&) = delete;
  SerialRegions& operator=(const SerialRegions&) = delete;
};

/// A CHOLMOD view of an Eigen matrix; nothing is copied.
cholmod_sparse view(const SparseMatrix& lower) {
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = static_cast<std::size_t>(lower.rows());
  sparse.nzmax = static_cast<std::size_t>(lower.nonZeros());
  sparse.p = const_cast<int*>(lower.outerIndexPtr());
  sparse.i = const_cast<int*>(lower.innerIndexPtr());
  sparse.x = const_cast<double*>(lower.valuePtr());
  sparse.stype = -1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_REAL;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = 1;
  sparse.packed = 1;
  return sparse;
}

std::vector<int> metis_order(const GroupGraph& graph) {
  const int count = graph.count();
  std::vector<int> order(count), inverse(count);
  if (graph.neighbours.empty()) {
    for (int i = 0; i < count; ++i) order[i] = i;
    return order;
  }
  static_assert(sizeof(idx_t) == sizeof(int));
  std::vector<int> starts = graph.starts, neighbours = graph.neighbours;
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  idx_t nodes = count;
  if (METIS_NodeND(&nodes, starts.data(), neighbours.data(), nullptr, options, order.data(), inverse.data()) !=
      METIS_OK) {
    throw std::runtime_error("METIS_NodeND failed on a graph of " + std::to_string(count) + " nodes");
  }
  return order;
}

}  // namespace

std::vector<int> fill_reducing_order(const GroupGraph& graph) {
  quiet_openmp();
  const int count = graph.count();
  if (count == 0) return {};
  std::vector<int> order = metis_order(graph);
  // CHOLMOD then refines the order by a postorder of the elimination tree, which makes its supernodes contiguous.
  Common c;
  std::vector<int> starts{0}, rows;
  for (int i = 0; i < count; ++i) {
    rows.push_back(i);
    for (int k = graph.starts[i]; k < graph.starts[i + 1]; ++k) {
      if (graph.neighbours[k] > i) rows.push_back(graph.neighbours[k]);
    }
    starts.push_back(static_cast<int>(rows.size()));
  }
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = static_cast<std::size_t>(count);
  sparse.nzmax = rows.size();
  sparse.p = starts.data();
  sparse.i = rows.data();
  sparse.stype = -1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_PATTERN;
  sparse.sorted = sparse.packed = 1;
  c.common.method[0].ordering = CHOLMOD_GIVEN;
  c.common.postorder = 1;
  cholmod_factor* factor = cholmod_analyze_p(&sparse, order.data(), nullptr, 0, &c.common);
  if (!factor) throw std::runtime_error("cholmod_analyze_p failed");
  std::memcpy(order.data(), factor->Perm, sizeof(int) * order.size());
  cholmod_free_factor(&factor, &c.common);
  return order;
}

struct Cholesky::Data {
  Common c;
  cholmod_factor* factor = nullptr;
  cholmod_dense *x = nullptr, *y = nullptr, *e = nullptr;
  int threads = 1, rough_threads = 1;
  std::optional<SubtreeCholesky> subtrees;  // with two threads, from the first factorisation on
  double flops = 0, nonzeros = 0;
  std::optional<SinglePrecisionFactor> single;  // from the first rough solve on
  bool rounded = false;                         // it holds the last factor
  ~Data() {
    cholmod_free_factor(&factor, &c.common);
    cholmod_free_dense(&x, &c.common);
    cholmod_free_dense(&y, &c.common);
    cholmod_free_dense(&e, &c.common);
  }
};

Cholesky::Cholesky(const SparseMatrix& lower, int threads) : data_(std::make_unique<Data>()) {
  quiet_openmp();
  if (lower.rows() == 0) return;  // everything is fixed; CHOLMOD takes no empty matrix
  data_->threads = lower.rows() >= threads_from ? threads : 1;
  data_->rough_threads = threads;
  data_->c.common.method[0].ordering = CHOLMOD_NATURAL;
  data_->c.common.postorder = 0;
  cholmod_sparse sparse = view(lower);
  data_->factor = cholmod_analyze(&sparse, &data_->c.common);
  if (!data_->factor)
    throw std::runtime_error("cholmod_analyze failed on a matrix of " + std::to_string(lower.rows()) + " rows");
  data_->flops = data_->c.common.fl;
  data_->nonzeros = data_->c.common.lnz;
}

Cholesky::~Cholesky() = default;
Cholesky::Cholesky(Cholesky&&) noexcept = default;
Cholesky& Cholesky::operator=(Cholesky&&) noexcept = default;

bool Cholesky::factorize(const SparseMatrix& lower, double shift) {
  Data& d = *data_;
  if (lower.rows() == 0) return true;
  const SerialRegions serial;
  d.rounded = false;
  if (d.threads > 1 && d.factor->is_super) {
    if (!d.subtrees) {
      cholmod_change_factor(CHOLMOD_REAL, true, true, true, true, d.factor, &d.c.common);  // room for its values
      if (d.c.common.status != CHOLMOD_OK) throw std::bad_alloc();
      d.subtrees.emplace(*d.factor, d.threads);
    }
    if (!d.subtrees->factorize(lower, shift)) return false;
  } else {
    openblas_set_num_threads(1);
    cholmod_sparse sparse = view(lower);
    double beta[2] = {shift, 0.0};
    cholmod_factorize_p(&sparse, beta, nullptr, 0, d.factor, &d.c.common);
    if (d.c.common.status != CHOLMOD_OK || d.factor->minor < d.factor->n) return false;
  }
  // A NaN passes CHOLMOD's test for positive pivots; its condition estimate is 0 there, and at infinite pivots.
  return cholmod_rcond(d.factor, &d.c.common) > 0;
}

void Cholesky::solve(const Vector& b, Vector& x) {
  Data& d = *data_;
  if (b.size() == 0) {
    x.resize(0);
    return;
  }
  cholmod_dense rhs{};
  rhs.nrow = rhs.d = rhs.nzmax = static_cast<std::size_t>(b.size());
  rhs.ncol = 1;
  rhs.x = const_cast<double*>(b.data());
  rhs.xtype = CHOLMOD_REAL;
  rhs.dtype = CHOLMOD_DOUBLE;
  openblas_set_num_threads(1);
  const SerialRegions serial;
  cholmod_solve2(CHOLMOD_A, d.factor, &rhs, nullptr, &d.x, nullptr, &d.y, &d.e, &d.c.common);
  x = Eigen::Map<const Vector>(static_cast<const double*>(d.x->x), b.size());
}

void Cholesky::solve_roughly(const Vector& b, Vector& x) {
  Data& d = *data_;
  if (b.size() == 0 || !d.factor->is_super) return solve(b, x);
  if (!d.single) d.single.emplace(*d.factor, d.rough_threads);
  if (!d.rounded) d.single->round();
  d.rounded = true;
  d.single->solve(b, x);
}

double Cholesky::factor_nonzeros() const { return data_->nonzeros; }
double Cholesky::factor_flops() const { return data_->flops; }
std::size_t Cholesky::memory_bytes() const {
  const Data& d = *data_;
  return d.c.common.memory_inuse + (d.single ? d.single->memory_bytes() : 0) +
         (d.subtrees ? d.subtrees->memory_bytes() : 0);
}

}  // namespace taut
