// The only file that sees CGAL. Its readers (Stream_support) are LGPL-3+; nothing here needs CGAL's GPL packages.
#ifdef TAUT_WITH_CGAL

#define CGAL_NDEBUG  // its assertions would print to stderr; what it returns is checked here instead

#include <CGAL/IO/OFF.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/IO/STL.h>
#include <CGAL/Simple_cartesian.h>

#include <cstdint>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "geometry/ply_header.h"
#include "geometry/polygon_soup.h"
#include "geometry/topology.h"

namespace taut {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Points = std::vector<Point>;

/// Corners of a face, wide enough for what PLY can hold, negative numbers included. CGAL resizes it to the number that
/// the file gives, which in a damaged file can be thousands of millions.
struct Polygon : std::vector<std::int64_t> {
  void resize(std::size_t corners) {
    constexpr std::size_t most_corners = 1 << 16;
    if (corners > most_corners) throw std::length_error("a face with more corners than any real one");
    std::vector<std::int64_t>::resize(corners);
  }
};
using Polygons = std::vector<Polygon>;

[[noreturn]] void refuse(const std::string& file, const std::string& what) { throw MeshError(file + ": " + what); }

/// CGAL reserves what the header promises, so one that promises more than the file can hold is refused first. Binary
/// OFF is refused because CGAL 5.5 does not skip the colours that end its faces and misreads the rest.
void require_readable_off_header(std::istream& in, const std::string& file, std::uintmax_t file_size) {
  CGAL::File_header_OFF header;
  in >> header;
  if (!in.good()) refuse(file, "no header of an OFF file");
  if (header.binary()) refuse(file, "binary OFF files are not read, save it as text");
  if (header.size_of_vertices() > file_size || header.size_of_facets() > file_size) {
    refuse(file, "the header promises more vertices or faces than the file can hold");
  }
}

bool read(std::istream& in, const std::string& file, const std::string& extension, std::uintmax_t file_size,
          Points& points, Polygons& polygons) {
  const auto quiet = CGAL::parameters::verbose(false);
  if (extension == ".stl") return CGAL::IO::read_STL(in, points, polygons, quiet);
  if (extension == ".off") {
    require_readable_off_header(in, file, file_size);
    in.seekg(0);
    return CGAL::IO::read_OFF(in, points, polygons, quiet);
  }
  require_readable_ply_header(in, file, file_size);
  in.seekg(0);
  // At the end of a truncated binary file CGAL would go on with numbers it never read.
  in.exceptions(std::ios::failbit | std::ios::badbit);
  return CGAL::IO::read_PLY(in, points, polygons, quiet);
}

}  // namespace

PolygonSoup read_through_cgal(const std::filesystem::path& path, const std::string& extension) {
  const std::string file = path.string();
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(file, "cannot be opened");
  Points points;
  Polygons polygons;
  bool complete = false;
  try {
    complete = read(in, file, extension, std::filesystem::file_size(path), points, polygons);
  } catch (const MeshError&) {
    throw;
  } catch (const std::exception&) {  // what CGAL, the stream or a container says means nothing to a person
    complete = false;
  }
  if (!complete)
    refuse(file, "not a complete " + extension.substr(1) + " file (truncated, malformed or of another kind)");

  PolygonSoup soup;
  for (const Point& p : points) {
    soup.points.emplace_back(p.x(), p.y(), p.z());
    if (!soup.points.back().allFinite())
      refuse(file, "vertex " + std::to_string(soup.points.size() - 1) + ": coordinates are not finite");
  }
  for (const Polygon& polygon : polygons) {
    for (const std::int64_t v : polygon) {
      if (v >= 0 && v < static_cast<std::int64_t>(points.size())) continue;
      refuse(file, "face " + std::to_string(soup.polygons.size()) + ": vertex " + std::to_string(v) +
                       " is out of range, the file has " + std::to_string(points.size()) + " (counted from 0)");
    }
    soup.polygons.emplace_back(polygon.begin(), polygon.end());
  }
  return soup;
}

}  // namespace taut

#endif  // TAUT_WITH_CGAL
