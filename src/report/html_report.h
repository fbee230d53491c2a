#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace taut {

/// True where this build holds the page, which needs npm (docs/decisions/0016).
bool has_report_page();

/// Writes a static SVG for each chart and heat map of `report`, named after its id, and returns the files. Throws as
/// write_html_report().
std::vector<std::filesystem::path> write_report_pictures(const std::filesystem::path& folder,
                                                         const nlohmann::json& report);

/// Writes `folder`/index.html, one page that needs no network, and the pictures beside it. Returns the files, the page
/// first.
///
/// `report` may have: "title", "command", "version", "machine" (an object); "summary" (sentences); "settings" (any
/// JSON); "charts" ({"id", "title", "x" and "y" {"label", "log"}, "series" [{"name", "line", "points" [{"x", "y",
/// "status", "label", "command"}]}], "front" [[x, y]]}): a point whose status is not "solved" is hollow, a y of null
/// stands at the top edge; "heat_maps" ({"id", "title", "knob", "values", "methods", "cells" [method][value]
/// {"outcome", "text", "command"}} with the outcomes solved, honest_failure, false_success, crash, timeout,
/// not_applicable); "tables" ({"id", "title", "columns", "rows"} with strings, numbers and null); "viewer"
/// (viewer_data()).
///
/// Throws std::invalid_argument for a report that lacks a part of one of these or has an id that is no plain file name,
/// std::runtime_error where this build has no page, FileError.
std::vector<std::filesystem::path> write_html_report(const std::filesystem::path& folder, const nlohmann::json& report);

}  // namespace taut
