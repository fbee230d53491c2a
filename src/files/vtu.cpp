#include "files/vtu.h"

#include <fmt/format.h>

#include <bit>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string_view>

#include "files/atomic_file.h"
#include "files/surface_check.h"
#include "files/xml.h"

namespace taut {
namespace {

static_assert(std::endian::native == std::endian::little, "the files say byte_order=\"LittleEndian\"");

void check_fields(std::string_view list, const std::vector<Field>& fields, std::size_t count) {
  std::set<std::string_view> names;
  for (const Field& field : fields) {
    if (field.name.empty())
      throw std::invalid_argument(fmt::format("write_vtu: {} holds a field without a name", list));
    if (!names.insert(field.name).second) {
      throw std::invalid_argument(fmt::format("write_vtu: {} holds '{}' twice", list, field.name));
    }
    if (field.components < 1) {
      throw std::invalid_argument(
          fmt::format("write_vtu: {} '{}' must have at least 1 component, got {}", list, field.name, field.components));
    }
    const std::size_t expected = count * static_cast<std::size_t>(field.components);
    if (field.values.size() != expected) {
      throw std::invalid_argument(fmt::format("write_vtu: {} '{}' must hold {} values, got {}", list, field.name,
                                              expected, field.values.size()));
    }
  }
}

/// The declarations in the XML and, behind them, the blocks of bytes that they point to.
class AppendedArrays {
 public:
  std::string declare_doubles(std::string_view name, int components, const double* values, std::size_t count) {
    return declare("Float64", name, fmt::format("NumberOfComponents=\"{}\"", components), values,
                   count * sizeof(double));
  }
  std::string declare(std::string_view type, std::string_view name, std::string_view shape, const void* data,
                      std::size_t size) {
    const std::size_t offset = blocks_.size();
    const std::uint64_t prefix = size;
    blocks_.append(reinterpret_cast<const char*>(&prefix), sizeof prefix);
    if (size > 0) blocks_.append(static_cast<const char*>(data), size);
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" {} format=\"appended\" offset=\"{}\"/>\n", type,
                       xml_escaped(name), shape, offset);
  }
  std::string declare_fields(const std::vector<Field>& fields) {
    std::string text;
    for (const Field& field : fields)
      text += declare_doubles(field.name, field.components, field.values.data(), field.values.size());
    return text;
  }
  const std::string& blocks() const { return blocks_; }

 private:
  std::string blocks_;
};

std::string declare_cells(AppendedArrays& arrays, const std::vector<Triangle>& triangles) {
  constexpr std::uint8_t vtk_triangle = 5;
  std::vector<std::int64_t> connectivity, offsets;
  for (const Triangle& triangle : triangles) {
    connectivity.insert(connectivity.end(), triangle.begin(), triangle.end());
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
  }
  const std::vector<std::uint8_t> types(triangles.size(), vtk_triangle);
  constexpr std::string_view shape = "NumberOfComponents=\"1\"";
  std::string text =
      arrays.declare("Int64", "connectivity", shape, connectivity.data(), connectivity.size() * sizeof(std::int64_t));
  text += arrays.declare("Int64", "offsets", shape, offsets.data(), offsets.size() * sizeof(std::int64_t));
  text += arrays.declare("UInt8", "types", shape, types.data(), types.size());
  return text;
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const Frame& frame) {
  check_surface("write_vtu", frame.positions, frame.triangles);
  const auto coordinates = static_cast<std::size_t>(frame.positions.size());
  const std::size_t points = coordinates / 3;
  check_fields("point_fields", frame.point_fields, points);
  check_fields("cell_fields", frame.cell_fields, frame.triangles.size());

  AppendedArrays arrays;
  std::string text = "<?xml version=\"1.0\"?>\n";
  text +=
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n";
  text += "<FieldData>\n";
  text += arrays.declare("Float64", "TimeValue", "NumberOfTuples=\"1\"", &frame.time, sizeof frame.time);
  text +=
      fmt::format("</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", points, frame.triangles.size());
  text += "<PointData>\n" + arrays.declare_fields(frame.point_fields) + "</PointData>\n";
  text += "<CellData>\n" + arrays.declare_fields(frame.cell_fields) + "</CellData>\n";
  text += "<Points>\n" + arrays.declare_doubles("Points", 3, frame.positions.data(), coordinates) + "</Points>\n";
  text += "<Cells>\n" + declare_cells(arrays, frame.triangles) + "</Cells>\n";
  text += "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  text += arrays.blocks();
  text += "\n</AppendedData>\n</VTKFile>\n";
  write_atomically(path, text);
}

void write_pvd(const std::filesystem::path& path, const std::vector<std::pair<double, std::string>>& frames) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const auto& [time, file] : frames) {
    text += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", time, xml_escaped(file));
  }
  write_atomically(path, text + "</Collection>\n</VTKFile>\n");
}

}  // namespace taut
