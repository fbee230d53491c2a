#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/types.h"
#include "files/file_error.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// Numbers on the points or the cells of a frame: `components` consecutive values for each.
struct Field {
  std::string name;
  int components = 1;
  std::vector<double> values;
};

/// A triangle surface at one time, with what is known at its vertices and in its triangles.
struct Frame {
  double time = 0;   ///< s
  Vector positions;  ///< x, y, z of each vertex, m
  std::vector<Triangle> triangles;
  std::vector<Field> point_fields;
  std::vector<Field> cell_fields;
};

/// Writes the frame atomically as a VTK XML UnstructuredGrid with raw appended data, so that every double keeps its
/// bits. Throws std::invalid_argument where sizes, indices or names do not fit (names: not empty, no two alike in a
/// list), FileError.
void write_vtu(const std::filesystem::path& path, const Frame& frame);

/// Reads what write_vtu() has written, and triangles of other programs whose arrays are ASCII text or of the very same
/// layout; anything else is refused with a FileError.
Frame read_vtu(const std::filesystem::path& path);

/// Writes atomically the list of frames that ParaView opens as one animation: times in seconds, files relative to the
/// PVD's folder. Rewriting it after every frame keeps it valid at any moment. Throws FileError.
void write_pvd(const std::filesystem::path& path, const std::vector<std::pair<double, std::string>>& frames);

}  // namespace taut
