#include "linalg/symmetric_indefinite.h"

#include <dmumps_c.h>

#include <cmath>
#include <stdexcept>
#include <string>

extern "C" void openblas_set_num_threads(int);

namespace taut {
namespace {

constexpr int use_comm_world = -987654;  // MUMPS's name for MPI_COMM_WORLD, which its sequential library ignores

enum Job { initialise = -1, terminate = -2, analyse = 1, factorise = 2, substitute = 3 };

}  // namespace

struct SymmetricIndefinite::Data {
  mutable DMUMPS_STRUC_C mumps{};
  std::vector<int> rows, columns, order;
  Vector values;

  // Numbers as in the manual, which counts from 1.
  int& icntl(int k) { return mumps.icntl[k - 1]; }
  int infog(int k) const { return mumps.infog[k - 1]; }
  /// Counts above 2^31 come negative, in millions.
  double count(int k) const { return infog(k) < 0 ? -1e6 * infog(k) : infog(k); }
  void run(Job job) const {
    openblas_set_num_threads(1);
    mumps.job = job;
    dmumps_c(&mumps);
  }
  Data() {
    mumps.par = 1;
    mumps.sym = 2;
    mumps.comm_fortran = use_comm_world;
    run(initialise);
    for (const int output : {1, 2, 3, 4}) icntl(output) = output == 4 ? 0 : -1;
  }
  ~Data() { run(terminate); }
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;
};

SymmetricIndefinite::SymmetricIndefinite(Index size, const std::vector<int>& rows, const std::vector<int>& columns,
                                         const std::vector<int>& order)
    : data_(std::make_unique<Data>()) {
  Data& d = *data_;
  for (const int row : rows) d.rows.push_back(row + 1);
  for (const int column : columns) d.columns.push_back(column + 1);
  d.mumps.n = static_cast<int>(size);
  d.mumps.nnz = static_cast<MUMPS_INT8>(rows.size());
  d.mumps.irn = d.rows.data();
  d.mumps.jcn = d.columns.data();
  d.icntl(7) = order.empty() ? 3 : 1;
  if (!order.empty()) {
    d.order.resize(order.size());
    for (std::size_t k = 0; k < order.size(); ++k)
      d.order[static_cast<std::size_t>(order[k])] = static_cast<int>(k) + 1;
    d.mumps.perm_in = d.order.data();
  }
  // Measured: at 0.01, the default, an indefinite matrix took 70 times as long as a quasi-definite one.
  d.mumps.cntl[0] = 1e-6;  // smallest pivot, relative to its column
  d.icntl(8) = 0;          // no scaling: that takes longer than it saves, and who calls can do better
  d.icntl(12) = 1;         // the usual ordering, no compression of 2x2 pivots, which would need values
  d.icntl(14) = 50;        // per cent of memory for pivots that are delayed
  if (size == 0) return;
  d.run(analyse);
  if (d.infog(1) < 0)
    throw std::runtime_error("MUMPS: analysis failed with " + std::to_string(d.infog(1)) + ", " +
                             std::to_string(d.infog(2)));
}

SymmetricIndefinite::~SymmetricIndefinite() = default;
SymmetricIndefinite::SymmetricIndefinite(SymmetricIndefinite&&) noexcept = default;
SymmetricIndefinite& SymmetricIndefinite::operator=(SymmetricIndefinite&&) noexcept = default;

bool SymmetricIndefinite::factorize(const Vector& values) {
  Data& d = *data_;
  if (d.mumps.n == 0) return true;
  if (!values.allFinite()) return false;
  d.values = values;
  d.mumps.a = d.values.data();
  d.run(factorise);
  constexpr int too_little_memory = -9, too_little_integer_memory = -8;
  while ((d.infog(1) == too_little_memory || d.infog(1) == too_little_integer_memory) && d.icntl(14) < 2000) {
    d.icntl(14) *= 2;
    d.run(factorise);
  }
  return d.infog(1) >= 0;
}

Index SymmetricIndefinite::negative_pivots() const { return data_->mumps.n == 0 ? 0 : data_->infog(12); }

void SymmetricIndefinite::solve(Vector& x) const {
  if (x.size() == 0) return;
  data_->mumps.rhs = x.data();
  data_->run(substitute);
}

double SymmetricIndefinite::factor_nonzeros() const { return data_->count(29); }
double SymmetricIndefinite::factor_flops() const { return data_->mumps.rinfog[2]; }
std::size_t SymmetricIndefinite::memory_bytes() const { return static_cast<std::size_t>(data_->infog(22)) * 1000000; }

}  // namespace taut
