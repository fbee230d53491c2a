#include <cstddef>
#include <cstdio>
#include <map>
#include <string>
#include <utility>

#include "problems/nl_term.h"

// AMPL's macros end with this file, as those of asl_pfgh.h, which does not go with nlp.h, do with nl_model.cpp.
#include <nlp.h>
#undef min
#undef max
#undef exit
#undef filename

namespace taut {
namespace {

constexpr int operators = 83;  // entries of r_ops_ASL
constexpr int sum_of_list = 54, constant_exponent = 76, square = 77, constant_base = 78, number = 80, variable = 82;

/// The expression trees of AMPL's library, walked.
class Splitter {
 public:
  Splitter(ASL_fg* asl, int most) : asl_(asl), most_(static_cast<std::size_t>(most)) {
    for (int i = operators - 1; i >= 0; --i) numbers_[r_ops_ASL[i]] = i;
  }

  /// Appends the terms of factor times the expression; false where one of them is none.
  bool split(const expr* e, double factor, std::vector<NlTerm>& terms) {
    switch (operator_of(e)) {
      case static_cast<int>(NlOperator::plus):
        return split(e->L.e, factor, terms) && split(e->R.e, factor, terms);
      case static_cast<int>(NlOperator::minus):
        return split(e->L.e, factor, terms) && split(e->R.e, -factor, terms);
      case static_cast<int>(NlOperator::negate):
        return split(e->L.e, -factor, terms);
      case static_cast<int>(NlOperator::times):
        if (operator_of(e->L.e) == number) return split(e->R.e, factor * value_of(e->L.e), terms);
        if (operator_of(e->R.e) == number) return split(e->L.e, factor * value_of(e->R.e), terms);
        break;
      case sum_of_list:
        for (expr** part = e->L.ep; part < e->R.ep; ++part) {
          if (!split(*part, factor, terms)) return false;
        }
        return true;
      case number:
        return true;
      default:
        break;
    }
    term_ = {};
    places_.clear();
    defined_.clear();
    int top = add(e);
    if (top >= 0 && factor != 1) top = combine(NlOperator::times, constant(factor), top);
    if (top < 0) return false;
    if (!term_.variables.empty()) terms.push_back(std::move(term_));
    return true;
  }

 private:
  int operator_of(const expr* e) const {
    const auto found = numbers_.find(e->op);
    return found == numbers_.end() ? -1 : found->second;
  }
  static double value_of(const expr* e) { return reinterpret_cast<const expr_n*>(e)->v; }

  int push(const NlTerm::Node& node) {
    term_.nodes.push_back(node);
    return static_cast<int>(term_.nodes.size()) - 1;
  }
  int constant(double value) { return push({NlOperator::constant, -1, -1, value}); }
  int combine(NlOperator what, int left, int right) { return left < 0 || right < 0 ? -1 : push({what, left, right}); }

  /// Adds the nodes of an expression and returns the last; -1 where it cannot be added.
  int add(const expr* e) {
    const int what = operator_of(e);
    switch (what) {
      case number:
        return constant(value_of(e));
      case variable:
        return add_variable(static_cast<int>(reinterpret_cast<const expr_v*>(e) - asl_->I.var_e_));
      case sum_of_list: {
        int sum = constant(0);
        for (expr** part = e->L.ep; part < e->R.ep && sum >= 0; ++part)
          sum = combine(NlOperator::plus, sum, add(*part));
        return sum;
      }
      case square: {
        const int base = add(e->L.e);
        return combine(NlOperator::power, base, constant(2));
      }
      case constant_exponent:
      case constant_base:
        break;
      default:
        if (!known(what)) return -1;
    }
    const bool power = what == constant_exponent || what == constant_base;
    const bool binary =
        power || what <= static_cast<int>(NlOperator::power) || what == static_cast<int>(NlOperator::atan2);
    const int left = add(e->L.e), right = binary ? add(e->R.e) : -1;
    if (left < 0 || (binary && right < 0)) return -1;
    return push({power ? NlOperator::power : static_cast<NlOperator>(what), left, right});
  }

  static bool known(int what) {
    const bool arithmetic = what >= 0 && what <= static_cast<int>(NlOperator::power) && what != 4;
    return arithmetic || what == static_cast<int>(NlOperator::negate) ||
           (what >= static_cast<int>(NlOperator::tanh) && what <= static_cast<int>(NlOperator::acos));
  }

  /// A variable of the model, or behind those one that the model defines by an expression and a linear part.
  int add_variable(int index) {
    ASL_fg* asl = asl_;
    if (index < n_var) {
      const auto [found, is_new] = places_.emplace(index, static_cast<int>(places_.size()));
      if (places_.size() > most_) return -1;
      if (is_new) term_.variables.push_back(index);
      return push({NlOperator::variable, found->second});
    }
    if (const auto found = defined_.find(index); found != defined_.end()) return found->second;
    const int common = index - n_var;
    const bool shared = common < ncom0;
    const expr* e = shared ? cexps[common].e : cexps1[common - ncom0].e;
    const linpart* linear = shared ? cexps[common].L : cexps1[common - ncom0].L;
    const int count = shared ? cexps[common].nlin : cexps1[common - ncom0].nlin;
    int sum = add(e);
    for (int k = 0; k < count && sum >= 0; ++k) {
      const auto* place = reinterpret_cast<const char*>(linear[k].v.rp) - offsetof(expr_v, v);
      const int one = add_variable(static_cast<int>(reinterpret_cast<const expr_v*>(place) - asl->I.var_e_));
      sum = combine(NlOperator::plus, sum, combine(NlOperator::times, constant(linear[k].fac), one));
    }
    return defined_[index] = sum;
  }

  ASL_fg* asl_;
  std::size_t most_;
  std::map<efunc*, int> numbers_;
  NlTerm term_;
  std::map<int, int> places_;   // variable of the model -> of the term
  std::map<int, int> defined_;  // defined variable -> its node
};

}  // namespace

std::vector<NlTerm> objective_terms(const std::filesystem::path& file, int most) {
  ASL* const made = ASL_alloc(ASL_read_fg);
  auto* asl = reinterpret_cast<ASL_fg*>(made);
  return_nofile = 1;
  const std::string stub = std::filesystem::path(file).replace_extension().string();
  std::vector<NlTerm> terms;
  const auto read = [&] {
    FILE* opened = jac0dim_ASL(made, const_cast<char*>(stub.c_str()), static_cast<ftnlen>(stub.size()));
    want_derivs = 0;
    return opened && fg_read_ASL(made, opened, ASL_return_read_err) == ASL_readerr_none && n_obj > 0;
  };
  bool good = read() && Splitter(asl, most).split(obj_de[0].e, 1, terms);
  if (good) {
    for (const ograd* entry = Ograd[0]; entry; entry = entry->next) {
      if (entry->coef == 0) continue;
      terms.push_back(
          {{entry->varno},
           {{NlOperator::constant, -1, -1, entry->coef}, {NlOperator::variable, 0}, {NlOperator::times, 0, 1}}});
    }
  }
  ASL* freed = made;
  ASL_free(&freed);
  return good ? terms : std::vector<NlTerm>{};
}

}  // namespace taut
