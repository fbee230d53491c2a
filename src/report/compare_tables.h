#pragma once

#include <string>

#include "study/compare_records.h"

namespace taut {

/// A comparison for a person at a terminal: per problem a line per entry, headline columns first, then every false
/// success and why entries did not finish. `folder` is where its files are; empty: nowhere.
std::string compare_terminal(const Comparison& comparison, const std::string& folder);

/// The same as a page of Markdown (compare.md), with how it was measured.
std::string compare_markdown(const Comparison& comparison);

/// compare.csv: a header, then a line per entry and step.
std::string compare_csv(const Comparison& comparison);

}  // namespace taut
