#include "problems/nl_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
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

std::size_t longest(const std::vector<std::string>& names) {
  std::size_t length = 0;
  for (const std::string& name : names) length = std::max(length, name.size());
  return length;
}

using Rows = std::vector<const NlFile::Row*>;

/// For each variable, how many rows have it.
std::vector<int> column_counts(const Rows& rows, Index variables) {
  std::vector<int> counts(static_cast<std::size_t>(variables), 0);
  for (const NlFile::Row* row : rows) {
    for (const int variable : variables_of(row->function)) ++counts[static_cast<std::size_t>(variable)];
  }
  return counts;
}

/// The ten lines at the beginning. Every variable counts as nonlinear, which lets them keep their order.
std::string header(const std::string& name, const NlFile& file, const Rows& rows, const std::vector<int>& columns,
                   const std::vector<std::string>& row_names) {
  const auto count = [&](auto condition) { return std::count_if(rows.begin(), rows.end(), condition); };
  const auto ranges = count([](const NlFile::Row* row) {
    return std::isfinite(row->lower) && std::isfinite(row->upper) && row->lower < row->upper;
  });
  const auto equations = count([](const NlFile::Row* row) { return row->lower == row->upper; });
  const auto nonlinear = count([](const NlFile::Row* row) { return !row->function.nonlinear.is_zero(); });
  const Index n = file.start.size(), in_rows = nonlinear > 0 ? n : 0;
  std::string text = fmt::format("g3 1 1 0\t# problem {}\n", name);
  text += fmt::format(" {} {} 1 {} {} 0\n {} 1\n 0 0\n", n, rows.size(), ranges, equations, nonlinear);
  text += fmt::format(" {} {} {}\n 0 0 0 1\n 0 0 0 0 0\n", in_rows, n, in_rows);
  text += fmt::format(" {} {}\n {} {}\n 0 0 0 0 0\n", std::accumulate(columns.begin(), columns.end(), 0),
                      variables_of(file.objective).size(), longest(row_names), longest(file.variable_names));
  return text;
}

/// Expressions, first guesses of multipliers, start.
std::string functions_and_start(const NlFile& file, const Rows& rows) {
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) text += fmt::format("C{}\n", i) + rows[i]->function.nonlinear.text();
  text += "O0 0\n" + file.objective.nonlinear.text();
  std::string duals;
  int count = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i]->dual == 0) continue;
    duals += fmt::format("{} {}\n", i, rows[i]->dual);
    ++count;
  }
  if (count > 0) text += fmt::format("d{}\n", count) + duals;
  text += fmt::format("x{}\n", file.start.size());
  for (Index i = 0; i < file.start.size(); ++i) text += fmt::format("{} {}\n", i, file.start[i]);
  return text;
}

/// Bounds, and the sparsity of the Jacobian with the linear coefficients.
std::string bounds_and_gradients(const NlFile& file, const Rows& rows, const std::vector<int>& columns) {
  std::string text = rows.empty() ? "" : "r\n";
  for (const NlFile::Row* row : rows) text += bound(row->lower, row->upper);
  text += "b\n";
  for (Index i = 0; i < file.start.size(); ++i) text += bound(file.lower[i], file.upper[i]);
  text += fmt::format("k{}\n", columns.size() - 1);
  int total = 0;
  for (std::size_t i = 0; i + 1 < columns.size(); ++i) text += fmt::format("{}\n", total += columns[i]);
  for (std::size_t i = 0; i < rows.size(); ++i) text += gradient(fmt::format("J{}", i), rows[i]->function);
  return text + gradient("G0", file.objective);
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
  Rows sorted;
  for (const Row& row : rows) sorted.push_back(&row);
  std::stable_partition(sorted.begin(), sorted.end(),
                        [](const Row* row) { return !row->function.nonlinear.is_zero(); });
  std::vector<std::string> row_names;
  for (const Row* row : sorted) row_names.push_back(row->name);
  const std::vector<int> columns = column_counts(sorted, start.size());
  const auto beside = [&](const char* extension) { return std::filesystem::path(path).replace_extension(extension); };
  write_atomically(path, header(path.stem().string(), *this, sorted, columns, row_names) +
                             functions_and_start(*this, sorted) + bounds_and_gradients(*this, sorted, columns));
  write_atomically(beside(".col"), lines(variable_names));
  write_atomically(beside(".row"), lines(row_names));
}

}  // namespace taut
