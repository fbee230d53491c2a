#include "problems/schema.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "problems/scene.h"

namespace taut {
namespace {

using Json = nlohmann::ordered_json;

const Json& schema() {
  static const Json parsed = Json::parse(problem_schema());
  return parsed;
}

/// The verdict of valijson, which shares no code with ours.
bool oracle_accepts(const nlohmann::json& document) {
  static const auto oracle = [] {
    auto result = std::make_unique<valijson::Schema>();
    const nlohmann::json text = nlohmann::json::parse(problem_schema());
    const valijson::adapters::NlohmannJsonAdapter adapter(text);
    valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(adapter, *result);
    return result;
  }();
  valijson::Validator validator;
  return validator.validate(*oracle, valijson::adapters::NlohmannJsonAdapter(document), nullptr);
}

std::string error_of(Json document) {
  try {
    complete(document, schema(), "file.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string parse_error(const std::string& text) {
  try {
    parse_strict(text, "file.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Json good() {
  return Json::parse(R"({"format": 1, "time": {"integrator": "implicit_euler", "step": 0.01, "steps": 10},
    "bodies": {"cloth": {"mesh": {"grid": {"size": [1, 1], "cells": [4, 4]}}, "thickness": 1e-3, "density": 200,
                         "membrane": {"law": "stvk", "young_modulus": 1e4, "poisson_ratio": 0.3}}},
    "constraints": {"pins": {"type": "pin", "body": "cloth", "select": {"corners": ["x0y1"]}},
                    "limit": {"type": "strain_limit", "body": "cloth", "max": 1.1}},
    "loads": {"wind": {"type": "wind", "body": "cloth", "velocity": [1, 0, 0]}}})");
}

TEST(Schema, EveryKeyHasADescriptionAndAUnit) {
  int keys = 0;
  const std::function<void(const Json&, const std::string&)> visit = [&](const Json& node, const std::string& where) {
    if (node.is_object() && node.contains("properties")) {
      for (const auto& [key, property] : node["properties"].items()) {
        ++keys;
        EXPECT_FALSE(property.value("description", "").empty()) << where << "/" << key;
        EXPECT_FALSE(property.value("unit", "").empty()) << where << "/" << key;
      }
    }
    if (node.is_structured())
      for (const auto& [key, item] : node.items()) visit(item, where + "/" + key);
  };
  visit(schema(), "");
  EXPECT_GT(keys, 100);
}

TEST(Schema, UsesOnlyKeywordsThatOurCheckKnows) {
  const std::set<std::string> known{
      "$schema",       "$ref",          "title",    "description",      "unit",       "default",
      "type",          "const",         "enum",     "minimum",          "maximum",    "exclusiveMinimum",
      "items",         "minItems",      "maxItems", "exclusiveMaximum", "required",   "additionalProperties",
      "propertyNames", "minProperties", "oneOf",    "pattern",          "properties", "definitions"};
  const std::function<void(const Json&)> visit = [&](const Json& node) {
    for (const auto& [keyword, item] : node.items()) {
      EXPECT_TRUE(known.contains(keyword)) << keyword;
      if (keyword == "properties" || keyword == "definitions")
        for (const auto& [name, child] : item.items()) visit(child);
      if ((keyword == "items" || keyword == "additionalProperties" || keyword == "propertyNames") && item.is_object())
        visit(item);
      if (keyword == "oneOf")
        for (const Json& child : item) visit(child);
    }
  };
  visit(schema());
}

TEST(Schema, EveryCatalogueFilePassesOursAndValijson) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(TAUT_CATALOGUE)) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "atlas.json") continue;  // of taut stress
    std::ifstream stream(entry.path());
    Json document = parse_strict(std::string(std::istreambuf_iterator<char>(stream), {}), entry.path());
    EXPECT_TRUE(oracle_accepts(document)) << entry.path();
    EXPECT_EQ(error_of(document), "") << entry.path();
    complete(document, schema(), "");
    EXPECT_TRUE(oracle_accepts(document)) << entry.path() << " after completion";
    EXPECT_EQ(document["name"], entry.path().stem().string());
    EXPECT_FALSE(document["description"].get<std::string>().empty()) << entry.path();
    EXPECT_FALSE(document["look_for"].get<std::string>().empty()) << entry.path();
    names.insert(entry.path().stem());
  }
  EXPECT_GE(names.size(), 10u);
}

TEST(Schema, CompletionFillsDefaultsThatAreNested) {
  Json document = good();
  complete(document, schema(), "file.json");
  EXPECT_EQ(document["solver"]["tolerance"]["feasibility"], 1e-6);
  EXPECT_EQ(document["bodies"]["cloth"]["rest"]["from"], "initial");
  EXPECT_EQ(document["constraints"]["pins"]["motion"]["velocity"], Json({0, 0, 0}));
  EXPECT_EQ(document["constraints"]["limit"]["select"], Json({{"all", true}}));
  EXPECT_EQ(document["bodies"]["cloth"]["mesh"]["grid"]["diagonals"], "alternating");
  EXPECT_FALSE(document["bodies"]["cloth"].contains("bending"));
  const Json once = document;
  complete(document, schema(), "file.json");
  EXPECT_EQ(document, once);
}

TEST(Schema, NumbersAreSpeltOneWay) {
  Json document = good();
  document["time"]["steps"] = 10.0;
  document["gravity"] = {0, -0.0, 1};
  complete(document, schema(), "file.json");
  EXPECT_EQ(document["time"]["steps"].dump(), "10");
  EXPECT_EQ(document["gravity"].dump(), "[0.0,0.0,1.0]");
}

struct Bad {
  const char* pointer;   ///< what is set ...
  const char* value;     ///< ... to this; "delete" removes it
  const char* expected;  ///< the error after "file.json: "
};
void PrintTo(const Bad& bad, std::ostream* stream) { *stream << bad.pointer << " = " << bad.value; }

class BadDocument : public testing::TestWithParam<Bad> {};

TEST_P(BadDocument, IsRefusedInOneClearLineAndByValijson) {
  Json document = good();
  const Json::json_pointer pointer(GetParam().pointer);
  if (std::string(GetParam().value) == "delete")
    document[pointer.parent_pointer()].erase(pointer.back());
  else
    document[pointer] = Json::parse(GetParam().value);
  EXPECT_FALSE(oracle_accepts(document));
  EXPECT_EQ(error_of(document), std::string("file.json: ") + GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadDocument,
    testing::Values(
        Bad{"/constraints/limit/max", "-1", "/constraints/limit/max: found -1, allowed: a number > 0"},
        Bad{"/constraints/limit/max", "0", "/constraints/limit/max: found 0, allowed: a number > 0"},
        Bad{"/constraints/limit/max", "\"1.1\"", "/constraints/limit/max: found \"1.1\", allowed: a number > 0"},
        Bad{"/constraints/limit/max", "[1]", "/constraints/limit/max: found an array, allowed: a number > 0"},
        Bad{"/constraints/limit/max", "null", "/constraints/limit/max: found null, allowed: a number > 0"},
        Bad{"/constraints/limit/min", "-0.1", "/constraints/limit/min: found -0.1, allowed: a number >= 0"},
        Bad{"/constraints/limit/form", "\"matrx\"",
            "/constraints/limit/form: found \"matrx\", allowed: matrix, singular_values (did you mean \"matrix\"?)"},
        Bad{"/constraints/limit/axes", "\"x\"",
            "/constraints/limit/axes: unknown key, allowed: type, body, form, min, max, surface, select"},
        Bad{"/constraints/limit/type", "\"strain_limits\"",
            "/constraints/limit/type: found \"strain_limits\", allowed: pin, strain_limit, half_space, sphere (did you "
            "mean "
            "\"strain_limit\"?)"},
        Bad{"/constraints/limit/type", "delete",
            "/constraints/limit/type: missing, allowed: pin, strain_limit, half_space, sphere"},
        Bad{"/constraints/limit", "7", "/constraints/limit: found 7, allowed: an object"},
        Bad{"/constraints/a~1b", "{}",
            "/constraints/a~1b: found the name \"a/b\", allowed: a letter, then letters, digits, _ and -"},
        Bad{"/constraints/pins/axes", "\"zx\"",
            "/constraints/pins/axes: found \"zx\", allowed: x, y, z, xy, xz, yz, xyz"},
        Bad{"/constraints/pins/select", "{}",
            "/constraints/pins/select: found an empty object, allowed: exactly one of vertices, corners, edges, box, "
            "sphere, nearest, group, "
            "boundary, all"},
        Bad{"/constraints/pins/select", "{\"edge\": [\"x0\"]}",
            "/constraints/pins/select: found the keys \"edge\", allowed: exactly one of vertices, corners, edges, box, "
            "sphere, nearest, group, "
            "boundary, all (did you mean \"edges\"?)"},
        Bad{"/constraints/pins/select/all", "true",
            "/constraints/pins/select: found the keys \"corners\", \"all\", allowed: exactly one of vertices, corners, "
            "edges, box, sphere, "
            "nearest, group, boundary, all"},
        Bad{"/constraints/pins/select", "{\"all\": false}", "/constraints/pins/select/all: found false, allowed: true"},
        Bad{"/constraints/pins/select/corners/0", "\"x2y0\"",
            "/constraints/pins/select/corners/0: found \"x2y0\", allowed: x0y0, x1y0, x0y1, x1y1 (did you mean "
            "\"x0y0\"?)"},
        Bad{"/constraints/pins/select", "{\"nearest\": []}",
            "/constraints/pins/select/nearest: found an array of 0, allowed: an array of at least 1 arrays of 3 "
            "numbers, in m"},
        Bad{"/constraints/pins/select", "{\"vertices\": [1.5]}",
            "/constraints/pins/select/vertices/0: found 1.5, allowed: an integer >= 0 and <= 2147483647"},
        Bad{"/constraints/pins/motion", "{\"keyframes\": [{}]}",
            "/constraints/pins/motion/keyframes/0/time: missing, allowed: a number, in s"},
        Bad{"/time/stepp", "1",
            "/time/stepp: unknown key, allowed: integrator, step, steps, spectral_radius, beta, gamma, halvings, "
            "frequencies (did "
            "you mean "
            "\"step\"?)"},
        Bad{"/time/steps", "delete", "/time/steps: missing, allowed: an integer >= 1 and <= 10000000"},
        Bad{"/time/steps", "2.5", "/time/steps: found 2.5, allowed: an integer >= 1 and <= 10000000"},
        Bad{"/time/steps", "18446744073709551615",
            "/time/steps: found 18446744073709551615, allowed: an integer >= 1 and <= 10000000"},
        Bad{"/time/step", "true", "/time/step: found true, allowed: a number > 0, in s"},
        Bad{"/time/spectral_radius", "1.5", "/time/spectral_radius: found 1.5, allowed: a number >= 0 and <= 1"},
        Bad{"/gravity", "[0, 1]", "/gravity: found an array of 2, allowed: an array of 3 numbers, in m/s2"},
        Bad{"/gravity", "9.81", "/gravity: found 9.81, allowed: an array of 3 numbers, in m/s2"},
        Bad{"/gravity", "[0, \"a\\nb\", 0]", "/gravity/1: found \"a\\nb\", allowed: a number"},
        Bad{"/format", "2", "/format: found 2, allowed: 1"}, Bad{"/name", "3", "/name: found 3, allowed: a string"},
        Bad{"/bodies", "{}", "/bodies: found an empty object, allowed: at least one name"},
        Bad{"/bodies", "delete", "/bodies: missing, allowed: an object"},
        Bad{"/bodies/cloth/mesh", "delete", "/bodies/cloth/mesh: missing, allowed: an object"},
        Bad{"/bodies/cloth/mesh/file", "\"a.obj\"",
            "/bodies/cloth/mesh: found the keys \"grid\", \"file\", allowed: exactly one of grid, file"},
        Bad{"/bodies/cloth/mesh/grid/cells", "[0, 1]",
            "/bodies/cloth/mesh/grid/cells/0: found 0, allowed: an integer >= 1 and <= 4096"},
        Bad{"/bodies/cloth/membrane/poisson_ratio", "0.5",
            "/bodies/cloth/membrane/poisson_ratio: found 0.5, allowed: a number > -1 and < 0.5"},
        Bad{"/loads/wind/velocity", "delete", "/loads/wind/velocity: missing, allowed: an array of 3 numbers, in m/s"},
        Bad{"/solver", "{\"tolerance\": {\"feasibility\": 0}}",
            "/solver/tolerance/feasibility: found 0, allowed: a number > 0"}));

TEST(ParseStrict, AcceptsBothKindsOfComments) {
  EXPECT_EQ(parse_strict("// one\n{\"a\": /* two */ [1, {}], \"b\": {\"a\": 2}}", "file.json"),
            Json::parse(R"({"a": [1, {}], "b": {"a": 2}})"));
}

TEST(ParseStrict, RefusesASyntaxErrorWithLineAndColumn) {
  EXPECT_EQ(parse_error("{\n  \"a\": nan\n}").find("file.json: line 2, column 9: syntax error"), 0u)
      << parse_error("{\n  \"a\": nan\n}");
  EXPECT_EQ(parse_error("").find("file.json: line 1, column 1: "), 0u);
  EXPECT_EQ(parse_error("{} x").find("file.json: line 1, column 4: "), 0u) << parse_error("{} x");
  EXPECT_EQ(parse_error("{\"a\": Infinity}").find("file.json: line 1, column 7: "), 0u);
  EXPECT_EQ(parse_error(std::string(100000, '[')).find("file.json: line 1, column 100001: "), 0u);
}

TEST(ParseStrict, RefusesKeysThatOccurTwice) {
  EXPECT_EQ(parse_error(R"({"t": [{}, {"step": 1, "a": {"step": 3}, "step": 2}]})"),
            "file.json: /t/1/step: found the key twice, allowed: once");
}

TEST(ParseStrict, RefusesNumbersThatOverflow) {
  EXPECT_EQ(parse_error(R"({"time": {"b": 1, "step": 1e999}})"),
            "file.json: /time/step: found '1e999', allowed: a number that a double can hold");
}

}  // namespace
}  // namespace taut
