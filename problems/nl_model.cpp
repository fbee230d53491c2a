#include "problems/nl_model.h"

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <utility>

#include "files/file_error.h"
#include "problems/scene.h"

// AMPL's macros (min, max, exit, filename, ...) reach no further than this file; the standard headers come first.
#include <asl_pfgh.h>
#undef min
#undef max
#undef exit
#undef filename
#undef asl

namespace taut {

struct NlModel::Data {
  ASL* asl = nullptr;
  std::filesystem::path stub;
  std::string name;
  Vector lower, upper, row_lower, row_upper, start, start_dual;
  std::vector<std::vector<int>> row_variables;
  std::vector<int> objective_variables;
  bool linear_objective = true;
  // Nonzeros of the second derivatives, upper triangle by columns: of the objective, and of all rows together.
  SputInfo *objective_pattern = nullptr, *row_pattern = nullptr;
  // Work: all variables, of which a function reads its own; a gradient and second derivatives of all of them; where a
  // function has each variable.
  Vector x, gradient, weights, second;
  std::vector<int> place;

  ~Data() {
    if (asl) ASL_free(&asl);
  }
};

namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
  throw InputError(file.string() + ": " + what);
}

/// Where AMPL's library goes back to instead of ending the process, past no destructor of ours.
thread_local std::jmp_buf* way_back = nullptr;

/// False, with what the library says about it in `reason`, where it cannot read the file.
bool read_model(ASL* asl, const std::string& stub, std::string& reason) {
  std::jmp_buf back;
  char* said = nullptr;
  std::size_t length = 0;
  FILE* const console = std::exchange(Stderr, open_memstream(&said, &length));
  volatile bool good = false;
  way_back = &back;
  if (setjmp(back) == 0) {
    FILE* file = jac0dim(const_cast<char*>(stub.c_str()), static_cast<ftnlen>(stub.size()));
    want_xpi0 = 3;
    asl->i.nlvog = n_var;
    good = file && pfgh_read(file, ASL_return_read_err) == ASL_readerr_none;
  }
  way_back = nullptr;
  std::fclose(std::exchange(Stderr, console));
  reason.assign(said, length);
  std::free(said);
  for (char& c : reason) {
    if (c == '\n') c = ' ';
  }
  while (reason.ends_with(' ')) reason.pop_back();
  return good;
}

/// What a header announces that this reader or these solvers cannot serve; empty where there is nothing.
std::string unsupported(ASL* asl) {
  if (const int integers = nbv + niv + nlvbi + nlvci + nlvoi; integers > 0)
    return std::to_string(integers) + " integer variables, allowed: continuous ones only";
  if (n_lcon > 0) return std::to_string(n_lcon) + " logical conditions, allowed: none";
  if (n_cc > 0) return std::to_string(n_cc) + " complementarity conditions, allowed: none";
  if (nfunc > 0) return std::to_string(nfunc) + " functions of another library, allowed: none";
  if (n_obj > 1) return std::to_string(n_obj) + " objectives, allowed: at most 1";
  return "";
}

double bound(double value) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return value >= 1e20 ? infinity : value <= -1e20 ? -infinity : value;
}

}  // namespace

/// AMPL's library calls this where it would end the process, and finds ours first.
extern "C" void mainexit_ASL(int code) {
  if (way_back) std::longjmp(*way_back, 1);
  std::_Exit(code);
}

NlModel::NlModel(const std::filesystem::path& given) : data_(std::make_unique<Data>()) {
  Data& d = *data_;
  d.stub = given;
  if (d.stub.extension() == ".nl") d.stub.replace_extension();
  const std::filesystem::path path = d.stub.string() + ".nl";
  d.name = d.stub.filename().string();
  {
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse(path, "cannot be read");
    const int first = file.get();
    if (first != 'g' && first != 'b') refuse(path, "is no .nl file (the first letter is neither g nor b)");
  }
  d.asl = ASL_alloc(ASL_read_pfgh);
  ASL* asl = d.asl;
  return_nofile = 1;
  if (std::string said; !read_model(asl, d.stub.string(), said)) {
    const std::string reason = asl->i.n_var_ > 0 ? unsupported(asl) : "";
    refuse(path, reason.empty() ? "cannot be read by AMPL's solver library (" + said + ")" : "found " + reason);
  }
  if (const std::string reason = unsupported(asl); !reason.empty()) refuse(path, "found " + reason);

  const int n = n_var, m = n_con;
  d.lower.resize(n);
  d.upper.resize(n);
  for (int i = 0; i < n; ++i) {
    d.lower[i] = bound(LUv[2 * i]);
    d.upper[i] = bound(LUv[2 * i + 1]);
  }
  d.row_lower.resize(m);
  d.row_upper.resize(m);
  for (int i = 0; i < m; ++i) {
    d.row_lower[i] = bound(LUrhs[2 * i]);
    d.row_upper[i] = bound(LUrhs[2 * i + 1]);
  }
  d.start = X0 ? Vector(Eigen::Map<const Vector>(X0, n)) : Vector(Vector::Zero(n));
  d.start_dual = pi0 ? Vector(Eigen::Map<const Vector>(pi0, m)) : Vector(Vector::Zero(m));
  d.row_variables.resize(static_cast<std::size_t>(m));
  for (int i = 0; i < m; ++i) {
    for (const cgrad* entry = Cgrad[i]; entry; entry = entry->next) d.row_variables[i].push_back(entry->varno);
  }
  if (n_obj > 0) {
    for (const ograd* entry = Ograd[0]; entry; entry = entry->next) d.objective_variables.push_back(entry->varno);
    d.linear_objective = nlo == 0;
  }
  d.x = d.start;
  d.gradient.resize(n);
  d.weights = Vector::Zero(m);
  d.place.assign(static_cast<std::size_t>(n), -1);
  fint nonzeros = 0;
  if (!d.linear_objective) nonzeros = sphes_setup_ASL(asl, &d.objective_pattern, 0, 0, 0, 1);
  if (nlc > 0) nonzeros = std::max(nonzeros, sphes_setup_ASL(asl, &d.row_pattern, -1, 0, 1, 1));
  d.second.resize(nonzeros);
}

NlModel::~NlModel() = default;

const std::string& NlModel::name() const { return data_->name; }
std::filesystem::path NlModel::file() const { return data_->stub.string() + ".nl"; }
int NlModel::variables() const { return static_cast<int>(data_->lower.size()); }
int NlModel::rows() const { return static_cast<int>(data_->row_lower.size()); }
bool NlModel::has_objective() const { return data_->asl->i.n_obj_ > 0; }
bool NlModel::maximise() const { return has_objective() && data_->asl->i.objtype_[0] != 0; }
const Vector& NlModel::lower() const { return data_->lower; }
const Vector& NlModel::upper() const { return data_->upper; }
const Vector& NlModel::row_lower() const { return data_->row_lower; }
const Vector& NlModel::row_upper() const { return data_->row_upper; }
const Vector& NlModel::start() const { return data_->start; }
const Vector& NlModel::start_dual() const { return data_->start_dual; }
std::string NlModel::variable_name(int variable) const {
  ASL* asl = data_->asl;
  return var_name(variable);
}
std::string NlModel::row_name(int row) const {
  ASL* asl = data_->asl;
  return con_name(row);
}

const std::vector<int>& NlModel::variables_of(int function) const {
  return function == objective ? data_->objective_variables : data_->row_variables[static_cast<std::size_t>(function)];
}

bool NlModel::linear(int function) const {
  ASL* asl = data_->asl;
  return function == objective ? data_->linear_objective : function >= nlc;
}

double NlModel::evaluate(int function, const double* x, double* gradient, double* hessian) const {
  Data& d = *data_;
  ASL* asl = d.asl;
  const std::vector<int>& own = variables_of(function);
  const auto outside = [&] {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto width = static_cast<Index>(own.size());
    if (gradient) Eigen::Map<Vector>(gradient, width).setConstant(nan);
    if (hessian) Eigen::Map<Vector>(hessian, width * width).setConstant(nan);
    return nan;
  };
  for (std::size_t k = 0; k < own.size(); ++k) d.x[own[k]] = x[k];
  if (!d.x.allFinite()) {
    for (const int variable : own) d.x[variable] = d.start[variable];
    return outside();
  }
  fint error = 0;
  const double value = function == objective ? objval(0, d.x.data(), &error) : conival(function, d.x.data(), &error);
  if (error) return outside();
  if (!gradient && !hessian) return value;
  if (function == objective) {
    objgrd(0, d.x.data(), d.gradient.data(), &error);
  } else {
    congrd(function, d.x.data(), d.gradient.data(), &error);
  }
  if (error) return outside();
  if (gradient) {
    for (std::size_t k = 0; k < own.size(); ++k) gradient[k] = d.gradient[own[k]];
  }
  if (!hessian) return value;
  if (linear(function)) {
    std::fill(hessian, hessian + own.size() * own.size(), 0.0);
    return value;
  }
  SputInfo*& pattern = function == objective ? d.objective_pattern : d.row_pattern;
  if (function == objective) {
    sphes_ASL(asl, &pattern, d.second.data(), 0, nullptr, nullptr);
  } else {
    d.weights[function] = 1;
    sphes_ASL(asl, &pattern, d.second.data(), -1, nullptr, d.weights.data());
    d.weights[function] = 0;
  }
  std::fill(hessian, hessian + own.size() * own.size(), 0.0);
  for (std::size_t k = 0; k < own.size(); ++k) d.place[own[k]] = static_cast<int>(k);
  for (std::size_t j = 0; j < own.size(); ++j) {
    for (fint entry = pattern->hcolstarts[own[j]]; entry < pattern->hcolstarts[own[j] + 1]; ++entry) {
      const int i = d.place[pattern->hrownos[entry]];
      if (i >= 0) hessian[i + j * own.size()] = hessian[j + i * own.size()] = d.second[entry];
    }
  }
  for (const int variable : own) d.place[variable] = -1;
  return value;
}

double NlModel::value_at(int function, const Vector& x) const {
  return evaluate(function, Vector(x(variables_of(function))).data(), nullptr, nullptr);
}

void NlModel::write_solution(const std::string& message, int code, const Vector& x, const Vector& dual) const {
  ASL* asl = data_->asl;
  const std::filesystem::path path = data_->stub.string() + ".sol";
  std::error_code missing;
  std::filesystem::remove(path, missing);  // an older one would hide that this one cannot be written
  solve_result_num = code;
  Vector primal = x, multipliers = dual;
  write_sol(const_cast<char*>(message.c_str()), primal.data(), multipliers.data(), nullptr);
  if (!std::filesystem::exists(path)) throw FileError(path, "cannot be written");
}

}  // namespace taut
