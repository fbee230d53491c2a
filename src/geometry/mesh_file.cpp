#include "geometry/mesh_file.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <optional>
#include <system_error>

#include "geometry/polygon_soup.h"

namespace taut {
namespace {

using Polygon = std::vector<int>;

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

void require_readable(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw MeshError(path.string() + ": no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw MeshError(path.string() + ": not a file");
  if (std::filesystem::file_size(path, error) == 0) throw MeshError(path.string() + ": the file is empty");
}

/// Newell's normal, twice the area long; unlike a cross product at one corner it does not mind straight or slightly
/// twisted corners.
Vector3 mean_normal(const std::vector<Vector3>& points, const Polygon& polygon) {
  Vector3 normal = Vector3::Zero();
  const Vector3& origin = points[polygon[0]];
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    normal += (points[polygon[k]] - origin).cross(points[polygon[k + 1]] - origin);
  }
  return normal;
}

bool fan_is_sound(const std::vector<Vector3>& points, const Polygon& polygon, std::size_t apex, const Vector3& normal) {
  constexpr double smallest_cosine = 0.5;
  constexpr double smallest_relative_area = 1e-12;
  const std::size_t size = polygon.size();
  const Vector3& a = points[polygon[apex]];
  for (std::size_t k = 1; k + 1 < size; ++k) {
    const Vector3 &b = points[polygon[(apex + k) % size]], &c = points[polygon[(apex + k + 1) % size]];
    const Vector3 cross = (b - a).cross(c - a);
    const double longest_squared = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if (!(cross.norm() > smallest_relative_area * longest_squared)) return false;
    if (!(cross.dot(normal) > smallest_cosine * cross.norm() * normal.norm())) return false;
  }
  return true;
}

std::optional<std::size_t> fan_apex(const std::vector<Vector3>& points, const Polygon& polygon) {
  if (polygon.size() == 3) return 0;  // a bad triangle is for validate() to name
  const Vector3 normal = mean_normal(points, polygon);
  for (std::size_t apex = 0; apex < polygon.size(); ++apex) {
    if (fan_is_sound(points, polygon, apex, normal)) return apex;
  }
  return std::nullopt;
}

TriangleMesh triangulate(PolygonSoup&& soup, const std::string& file) {
  TriangleMesh mesh;
  for (std::size_t p = 0; p < soup.polygons.size(); ++p) {
    const Polygon& polygon = soup.polygons[p];
    const std::size_t size = polygon.size();
    const std::string place =
        soup.lines.empty() ? file + ": face " + std::to_string(p) : file + ":" + std::to_string(soup.lines[p]);
    if (size < 3) throw MeshError(place + ": a face with " + std::to_string(size) + " corners, expected at least 3");
    const std::optional<std::size_t> apex = fan_apex(soup.points, polygon);
    if (!apex) {
      throw MeshError(place + ": a face with " + std::to_string(size) +
                      " corners that no fan of triangles fits (dented, twisted or degenerate)");
    }
    for (std::size_t k = 1; k + 1 < size; ++k) {
      const std::size_t a = *apex, b = (a + k) % size, c = (a + k + 1) % size;
      mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
      if (!soup.corner_uv.empty())
        mesh.corner_uv.push_back({soup.corner_uv[p][a], soup.corner_uv[p][b], soup.corner_uv[p][c]});
    }
  }
  mesh.vertices = std::move(soup.points);
  mesh.groups = std::move(soup.groups);
  return mesh;
}

}  // namespace

TriangleMesh read_mesh(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  if (extension != ".obj" && extension != ".ply" && extension != ".off" && extension != ".stl") {
    throw MeshError(path.string() + ": unknown kind of mesh file \"" + extension +
                    "\", expected .obj, .ply, .off or .stl");
  }
  require_readable(path);
  PolygonSoup soup = extension == ".obj" ? read_obj(path) : read_through_cgal(path, extension);
  if (soup.polygons.empty()) throw MeshError(path.string() + ": the file has no faces");
  return triangulate(std::move(soup), path.string());
}

#ifndef TAUT_WITH_CGAL
PolygonSoup read_through_cgal(const std::filesystem::path& path, const std::string& extension) {
  throw MeshError(path.string() + ": " + extension + " files need a build with CGAL; this one reads .obj only");
}
#endif

}  // namespace taut
