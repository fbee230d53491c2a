#include "geometry/mesh_property.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sstream>

#include "geometry/ply_header.h"
#include "geometry/topology.h"

namespace taut {
namespace {

/// A scalar type of PLY: its names, bytes, and how they become a number.
struct Type {
  std::array<const char*, 2> names;
  std::size_t bytes;
  double (*value)(const char*);
};

template <class Number>
double value_of(const char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return static_cast<double>(number);
}

constexpr std::array<Type, 8> types{{{{"char", "int8"}, 1, value_of<std::int8_t>},
                                     {{"uchar", "uint8"}, 1, value_of<std::uint8_t>},
                                     {{"short", "int16"}, 2, value_of<std::int16_t>},
                                     {{"ushort", "uint16"}, 2, value_of<std::uint16_t>},
                                     {{"int", "int32"}, 4, value_of<std::int32_t>},
                                     {{"uint", "uint32"}, 4, value_of<std::uint32_t>},
                                     {{"float", "float32"}, 4, value_of<float>},
                                     {{"double", "float64"}, 8, value_of<double>}}};

const Type& type_named(const std::string& name) {
  return *std::find_if(types.begin(), types.end(),
                       [&](const Type& t) { return name == t.names[0] || name == t.names[1]; });
}

enum class Format { text, little_endian, big_endian };

/// What the header says of the vertices.
struct Vertices {
  Format format = Format::text;
  std::size_t count = 0;
  std::vector<const Type*> columns;
  std::size_t wanted = 0;  // the column of the property
};

/// Reads a header that require_readable_ply_header() has passed.
Vertices read_vertices(std::istream& in, const std::string& file, const std::string& name) {
  Vertices vertices;
  bool found = false, before = true;  // before: no element but the vertices has come yet
  std::string element, line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string word, type, property;
    words >> word;
    if (word == "end_header") break;
    if (word == "format") {
      words >> type;
      vertices.format = type == "ascii"                  ? Format::text
                        : type == "binary_little_endian" ? Format::little_endian
                                                         : Format::big_endian;
    } else if (word == "element") {
      words >> element;
      if (element == "vertex" || element == "vertices") {
        if (!before) throw MeshError(file + ": its vertices do not come first, so their properties are not read");
        words >> vertices.count;
      }
      before = false;
    } else if (word == "property" && (element == "vertex" || element == "vertices")) {
      words >> type >> property;
      if (type == "list") throw MeshError(file + ": its vertices have a list, so their properties are not read");
      if (property == name) {
        vertices.wanted = vertices.columns.size();
        found = true;
      }
      vertices.columns.push_back(&type_named(type));
    }
  }
  if (!found) throw MeshError(file + ": its vertices have no property \"" + name + "\"");
  return vertices;
}

double read_text(std::istream& in, const Vertices& vertices) {
  double value = 0, number = 0;
  for (std::size_t c = 0; c < vertices.columns.size(); ++c) {
    in >> number;
    if (c == vertices.wanted) value = number;
  }
  return value;
}

double read_binary(std::istream& in, const Vertices& vertices) {
  const bool swapped = (vertices.format == Format::little_endian) != (std::endian::native == std::endian::little);
  double value = 0;
  for (std::size_t c = 0; c < vertices.columns.size(); ++c) {
    std::array<char, 8> bytes{};
    const Type& type = *vertices.columns[c];
    in.read(bytes.data(), static_cast<std::streamsize>(type.bytes));
    if (swapped) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.bytes));
    if (c == vertices.wanted) value = type.value(bytes.data());
  }
  return value;
}

}  // namespace

std::vector<double> read_vertex_property(const std::filesystem::path& path, const std::string& name) {
  const std::string file = path.string();
  if (path.extension() != ".ply" && path.extension() != ".PLY")
    throw MeshError(file + ": only PLY files have properties of vertices");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw MeshError(file + ": cannot be opened");
  require_readable_ply_header(in, file, std::filesystem::file_size(path));
  in.seekg(0);
  const Vertices vertices = read_vertices(in, file, name);
  std::vector<double> values;
  for (std::size_t v = 0; v < vertices.count; ++v) {
    values.push_back(vertices.format == Format::text ? read_text(in, vertices) : read_binary(in, vertices));
    if (!in) throw MeshError(file + ": ends before vertex " + std::to_string(v));
  }
  return values;
}

}  // namespace taut
