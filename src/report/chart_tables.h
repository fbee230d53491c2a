#pragma once

#include <string>
#include <vector>

#include "report/text_table.h"
#include "study/chart_records.h"

namespace taut {

/// A row per point of a problem.
TextTable chart_points(const ProblemChart& problem);
/// A row per solver, with false successes and the share of correct runs first.
TextTable chart_scores(const ChartData& chart);

/// What a person reads first: the reference and how exact it is, the cheapest points below round errors, orders of
/// convergence, what is not solved.
std::vector<std::string> chart_words(const ChartData& chart, const ProblemChart& problem);

/// Tables and words, with where the files are; `folder` is empty where none are kept.
std::string chart_terminal(const ChartData& chart, const std::string& folder);

/// chart.csv: a line per point, references left out.
std::string chart_csv(const ChartData& chart);

}  // namespace taut
