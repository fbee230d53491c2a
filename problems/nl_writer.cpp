#include "problems/nl_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <set>

#include "files/atomic_file.h"

namespace taut {
namespace {

enum Opcode {
  plus = 0,
  minus = 1,
  times = 2,
  power = 5,
  negative = 16,
  root = 39,
  arc_tangent_of_two = 48,
  sum_of = 54
};

std::string operation(Opcode opcode, const std::string& operands) {
  return fmt::format("o{}\n{}", int{opcode}, operands);
}

/// The variables of a function, ascending.
std::set<int> variables_of(const NlFunction& function) {
  std::set<int> variables;
  for (const auto& [variable, coefficient] : function.linear) variables.insert(variable);
  const std::string& text = function.nonlinear.text();
  for (std::size_t line = 0; line < text.size(); line = text.find('\n', line) + 1) {
    if (text[line] == 'v') variables.insert(std::atoi(text.c_str() + line + 1));
  }
  return variables;
}

std::string bound(double lower, double upper) {
  if (lower == upper) return fmt::format("4 {}\n", lower);
  const bool below = std::isfinite(lower), above = std::isfinite(upper);
  if (below && above) return fmt::format("0 {} {}\n", lower, upper);
  if (above) return fmt::format("1 {}\n", upper);
  return below ? fmt::format("2 {}\n", lower) : "3\n";
}

/// "J3 2", "G0 5": the variables of a function with their linear coefficients.
std::string gradient(const std::string& head, const NlFunction& function) {
  const std::set<int> variables = variables_of(function);
  if (variables.empty()) return "";
  std::string text = fmt::format("{} {}\n", head, variables.size());
  for (const int variable : variables) {
    const auto found = function.linear.find(variable);
    text += fmt::format("{} {}\n", variable, found == function.linear.end() ? 0.0 : found->second);
  }
  return text;
}

std::string lines(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += name + "\n";
  return text;
}

}  // namespace

NlExpression::NlExpression(double constant) : text_(fmt::format("n{}\n", constant)) {}

NlExpression NlExpression::variable(int index) { return NlExpression(fmt::format("v{}\n", index)); }

NlExpression operator+(const NlExpression& a, const NlExpression& b) {
  return NlExpression(operation(plus, a.text_ + b.text_));
}

NlExpression operator-(const NlExpression& a, const NlExpression& b) {
  return NlExpression(operation(minus, a.text_ + b.text_));
}

NlExpression operator*(const NlExpression& a, const NlExpression& b) {
  return NlExpression(operation(times, a.text_ + b.text_));
}

NlExpression operator-(const NlExpression& a) { return NlExpression(operation(negative, a.text_)); }

NlExpression square(const NlExpression& a) { return NlExpression(operation(power, a.text_ + "n2\n")); }

NlExpression sqrt(const NlExpression& a) { return NlExpression(operation(root, a.text_)); }

NlExpression atan2(const NlExpression& y, const NlExpression& x) {
  return NlExpression(operation(arc_tangent_of_two, y.text_ + x.text_));
}

NlExpression sum(const std::vector<NlExpression>& terms) {
  if (terms.empty()) return 0;
  if (terms.size() == 1) return terms[0];
  if (terms.size() == 2) return terms[0] + terms[1];
  std::string text = fmt::format("{}\n", terms.size());
  for (const NlExpression& term : terms) text += term.text_;
  return NlExpression(operation(sum_of, text));
}

void NlFile::write(const std::filesystem::path& path) const {
  std::vector<const Row*> sorted;
  for (const Row& row : rows) sorted.push_back(&row);
  const auto nonlinear_end = std::stable_partition(sorted.begin(), sorted.end(),
                                                   [](const Row* row) { return !row->function.nonlinear.is_zero(); });
  const auto nonlinear = nonlinear_end - sorted.begin();
  const auto count = [&](auto condition) { return std::count_if(rows.begin(), rows.end(), condition); };
  const auto ranges = count(
      [](const Row& row) { return std::isfinite(row.lower) && std::isfinite(row.upper) && row.lower < row.upper; });
  const auto equations = count([](const Row& row) { return row.lower == row.upper; });
  const auto duals = count([](const Row& row) { return row.dual != 0; });
  std::vector<int> in_column(static_cast<std::size_t>(start.size()), 0);
  std::size_t entries = 0, longest_row = 0, longest_variable = 0;
  std::vector<std::string> row_names;
  for (const Row* row : sorted) {
    for (const int variable : variables_of(row->function)) ++in_column[static_cast<std::size_t>(variable)], ++entries;
    row_names.push_back(row->name);
    longest_row = std::max(longest_row, row->name.size());
  }
  for (const std::string& name : variable_names) longest_variable = std::max(longest_variable, name.size());

  const Index n = start.size();
  std::string text = fmt::format("g3 1 1 0\t# problem {}\n", path.stem().string());
  text += fmt::format(" {} {} 1 {} {} 0\n {} 1\n 0 0\n", n, rows.size(), ranges, equations, nonlinear);
  // Every variable counts as nonlinear, which puts them in no other order than the scene's.
  text += fmt::format(" {} {} {}\n 0 0 0 1\n 0 0 0 0 0\n", nonlinear > 0 ? n : 0, n, nonlinear > 0 ? n : 0);
  text += fmt::format(" {} {}\n {} {}\n 0 0 0 0 0\n", entries, variables_of(objective).size(), longest_row,
                      longest_variable);
  for (std::size_t i = 0; i < sorted.size(); ++i)
    text += fmt::format("C{}\n", i) + sorted[i]->function.nonlinear.text();
  text += "O0 0\n" + objective.nonlinear.text();
  if (duals > 0) text += fmt::format("d{}\n", duals);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (sorted[i]->dual != 0) text += fmt::format("{} {}\n", i, sorted[i]->dual);
  }
  text += fmt::format("x{}\n", n);
  for (Index i = 0; i < n; ++i) text += fmt::format("{} {}\n", i, start[i]);
  if (!sorted.empty()) text += "r\n";
  for (const Row* row : sorted) text += bound(row->lower, row->upper);
  text += "b\n";
  for (Index i = 0; i < n; ++i) text += bound(lower[i], upper[i]);
  text += fmt::format("k{}\n", n - 1);
  int total = 0;
  for (Index i = 0; i + 1 < n; ++i) text += fmt::format("{}\n", total += in_column[static_cast<std::size_t>(i)]);
  for (std::size_t i = 0; i < sorted.size(); ++i) text += gradient(fmt::format("J{}", i), sorted[i]->function);
  text += gradient("G0", objective);

  const auto beside = [&](const char* extension) { return std::filesystem::path(path).replace_extension(extension); };
  write_atomically(beside(".col"), lines(variable_names));
  write_atomically(beside(".row"), lines(row_names));
  write_atomically(path, text);
}

}  // namespace taut
