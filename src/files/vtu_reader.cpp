#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

#include "files/atomic_file.h"
#include "files/vtu.h"
#include "files/xml.h"

namespace taut {
namespace {

/// The value of an attribute of `tag`, empty where it has none.
std::string_view attribute(std::string_view tag, std::string_view name) {
  const std::string key = " " + std::string(name) + "=\"";
  const std::size_t begin = tag.find(key);
  if (begin == std::string_view::npos) return {};
  const std::string_view rest = tag.substr(begin + key.size());
  return rest.substr(0, rest.find('"'));
}

/// Reads the layout that write_vtu() writes, tags first and then the blocks of bytes they point to; and arrays whose
/// numbers stand between their tags as text.
class VtuReader {
 public:
  VtuReader(const std::filesystem::path& path, std::string_view bytes) : path_(path) {
    constexpr std::string_view mark = "<AppendedData encoding=\"raw\">\n_";
    const std::size_t end = bytes.find(mark);
    tags_ = bytes.substr(0, end);
    if (tags_.find("<VTKFile ") == std::string_view::npos) fail("is not a VTU file");
    if (end == std::string_view::npos && tags_.find("</VTKFile>") == std::string_view::npos) fail("is cut short");
    if (end != std::string_view::npos) blocks_ = bytes.substr(end + mark.size());
  }

  Frame read() {
    while (next_tag()) {
      if (starts("VTKFile")) {
        check_layout();
      } else if (starts("Piece")) {
        points_ = number("NumberOfPoints");
        cells_ = number("NumberOfCells");
      } else if (starts("DataArray")) {
        read_array();
      } else if (const std::string_view name = tag_.substr(0, tag_.find(' ')); is_section(name)) {
        section_ = name;
      }
    }
    if (static_cast<std::uint64_t>(frame_.positions.size()) != 3 * points_ || offsets_ != cells_ || types_ != cells_ ||
        frame_.triangles.size() != cells_) {
      fail("lacks its points or its cells");
    }
    return std::move(frame_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw FileError(path_, problem); }
  bool starts(std::string_view name) const {
    return tag_.starts_with(name) && tag_.substr(name.size()).starts_with(' ');
  }
  static bool is_section(std::string_view name) {
    return name == "FieldData" || name == "PointData" || name == "CellData" || name == "Points" || name == "Cells";
  }

  bool next_tag() {
    const std::size_t begin = tags_.find('<');
    if (begin == std::string_view::npos) return false;
    tags_.remove_prefix(begin + 1);
    tag_ = tags_.substr(0, tags_.find('>'));
    tags_.remove_prefix(tag_.size());
    return true;
  }

  void check_layout() const {
    if (attribute(tag_, "type") != "UnstructuredGrid") fail("is a VTK file, but not an UnstructuredGrid");
    if (blocks_.empty()) return;
    if (attribute(tag_, "byte_order") != "LittleEndian" || attribute(tag_, "header_type") != "UInt64" ||
        !attribute(tag_, "compressor").empty()) {
      fail("must be an uncompressed little-endian UnstructuredGrid with 64-bit headers");
    }
  }

  std::uint64_t number(std::string_view name, std::uint64_t largest = std::numeric_limits<int>::max()) const {
    const std::string_view text = attribute(tag_, name);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || text.empty() || value > largest) {
      fail("has no valid " + std::string(name) + " in <" + std::string(tag_) + ">");
    }
    return value;
  }

  /// The `count` numbers of the array that the current tag declares.
  template <typename Number>
  std::vector<Number> block(std::string_view type, std::uint64_t count) const {
    const std::string name(attribute(tag_, "Name"));
    const std::string_view format = attribute(tag_, "format");
    if (format == "ascii") return text_numbers<Number>(count);
    if (format != "appended") {
      fail("array '" + name + "' is stored as '" + std::string(format) +
           "', expected ascii or raw appended data (in ParaView: Data Mode Ascii)");
    }
    if (attribute(tag_, "type") != type) fail("array '" + name + "' must be of type " + std::string(type));
    const std::uint64_t offset = number("offset", std::numeric_limits<std::uint64_t>::max());
    std::uint64_t size = 0;
    if (offset > blocks_.size() || blocks_.size() - offset < sizeof size)
      fail("is cut short before array '" + name + "'");
    std::memcpy(&size, blocks_.data() + offset, sizeof size);
    if (size / sizeof(Number) != count || size % sizeof(Number) != 0) {
      fail("array '" + name + "' holds " + std::to_string(size) + " bytes, expected " + std::to_string(count) +
           " numbers");
    }
    if (size > blocks_.size() - offset - sizeof size) fail("is cut short inside array '" + name + "'");
    std::vector<Number> values(count);
    if (count > 0) std::memcpy(values.data(), blocks_.data() + offset + sizeof size, size);
    return values;
  }

  /// The numbers between the current tag and the next, of whatever type.
  template <typename Number>
  std::vector<Number> text_numbers(std::uint64_t count) const {
    const std::string name(attribute(tag_, "Name"));
    std::string_view text = tags_.substr(0, tags_.find('<'));
    text.remove_prefix(std::min<std::size_t>(1, text.size()));  // the '>'
    std::vector<Number> values;
    while (true) {
      const std::size_t begin = text.find_first_not_of(" \t\r\n");
      if (begin == std::string_view::npos) break;
      Number value{};
      const auto [rest, error] = std::from_chars(text.data() + begin, text.data() + text.size(), value);
      if (error != std::errc()) fail("array '" + name + "' holds something that is not a number");
      values.push_back(value);
      text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
    }
    if (values.size() != count) {
      fail("array '" + name + "' holds " + std::to_string(values.size()) + " numbers, expected " +
           std::to_string(count));
    }
    return values;
  }

  void read_array() {
    const std::string_view name = attribute(tag_, "Name");
    if (section_ == "FieldData") {
      if (name == "TimeValue") frame_.time = block<double>("Float64", 1).front();
    } else if (section_ == "PointData") {
      frame_.point_fields.push_back(field(points_));
    } else if (section_ == "CellData") {
      frame_.cell_fields.push_back(field(cells_));
    } else if (section_ == "Points") {
      const auto values = block<double>("Float64", 3 * points_);
      frame_.positions = Eigen::Map<const Vector>(values.data(), static_cast<Index>(values.size()));
    } else if (name == "connectivity") {
      read_triangles();
    } else if (name == "offsets") {
      for (const std::int64_t offset : block<std::int64_t>("Int64", cells_))
        check_cell(offset == static_cast<std::int64_t>(3 * ++offsets_));
    } else if (name == "types") {
      for (const std::uint8_t type : block<std::uint8_t>("UInt8", cells_)) check_cell(type == 5), ++types_;
    }
  }

  Field field(std::uint64_t count) const {
    const std::uint64_t components = attribute(tag_, "NumberOfComponents").empty() ? 1 : number("NumberOfComponents");
    return {xml_unescaped(attribute(tag_, "Name")), static_cast<int>(components),
            block<double>("Float64", count * components)};
  }

  void read_triangles() {
    const auto vertices = block<std::int64_t>("Int64", 3 * cells_);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i] < 0 || static_cast<std::uint64_t>(vertices[i]) >= points_) {
        fail("triangle " + std::to_string(i / 3) + " names vertex " + std::to_string(vertices[i]) + " of " +
             std::to_string(points_));
      }
      if (i % 3 == 0) frame_.triangles.emplace_back();
      frame_.triangles.back()[i % 3] = static_cast<int>(vertices[i]);
    }
  }

  void check_cell(bool is_triangle) const {
    if (!is_triangle) fail("holds cells that are not triangles");
  }

  const std::filesystem::path& path_;
  std::string_view tags_, blocks_, tag_, section_;
  std::uint64_t points_ = 0, cells_ = 0, offsets_ = 0, types_ = 0;
  Frame frame_;
};

}  // namespace

Frame read_vtu(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  return VtuReader(path, bytes).read();
}

}  // namespace taut
