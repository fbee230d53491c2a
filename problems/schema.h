#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace taut {

/// The published JSON Schema (draft-07) of problem files, compiled in from problems/problem.schema.json.
std::string_view problem_schema();

/// Parses JSON with comments. Throws InputError for syntax errors (with line and column), for keys that occur twice and
/// for numbers beyond the range of doubles. `source` is what errors call the text.
nlohmann::ordered_json parse_strict(std::string_view text, const std::string& source);

/// Checks `document` against `schema` and fills in its defaults; numbers become doubles or integers as the schema says.
/// Throws InputError for the first thing that does not fit, with what was found and what is allowed.
///
/// Knows the part of draft-07 that problem.schema.json uses: type, const, enum, bounds, items (one schema), minItems,
/// maxItems, properties, additionalProperties, required, minProperties, propertyNames (pattern), $ref into the schema,
/// and oneOf where the branch is told by a `const` key or by which single required key is there. `default` beside a
/// `$ref` counts.
void complete(nlohmann::ordered_json& document, const nlohmann::ordered_json& schema, const std::string& source);

}  // namespace taut
