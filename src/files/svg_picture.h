#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types.h"
#include "files/file_error.h"
#include "geometry/triangle_mesh.h"

namespace taut {

/// A triangle surface coloured by one number per triangle, seen without perspective.
struct Picture {
  struct Sphere {
    Vector3 center;     ///< m
    double radius = 0;  ///< m
  };

  Vector positions;                                  ///< x, y, z of each vertex, m
  const std::vector<Triangle>* triangles = nullptr;  ///< borrowed
  std::vector<double> triangle_values;               ///< one per triangle; those that are not finite are drawn grey
  double low = 0, high = 1;                          ///< the values at the ends of the colour scale
  std::string title;
  std::string value_name;        ///< what the colour means, with its unit: "tension, N/m" (room for 22 letters)
  Vector3 up = Vector3::Zero();  ///< the direction that points up in the picture; zero: z
  Vector3 view_from =
      Vector3::Zero();          ///< the direction from the scene to the eye; zero: from the front, the right and above
  std::vector<Sphere> spheres;  ///< obstacles, drawn as shaded discs
  std::vector<int> marked_vertices;  ///< drawn as dots: the pins
};

/// Writes the picture atomically as a self-contained SVG, framed to fit, with a legend. About 80 bytes a triangle.
/// Throws std::invalid_argument where sizes or indices do not fit or a position is not finite, FileError.
void write_svg(const std::filesystem::path& path, const Picture& picture);

}  // namespace taut
