#include "geometry/tetrahedra.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <string>

#include "geometry/topology.h"

namespace taut {
namespace {

double volume(const std::vector<Vector3>& x, const Tetrahedron& c) {
  return (x[c[1]] - x[c[0]]).cross(x[c[2]] - x[c[0]]).dot(x[c[3]] - x[c[0]]) / 6;
}

class MshReader {
 public:
  explicit MshReader(const std::filesystem::path& file) : name_(file.string()), stream_(file) {
    if (!stream_) fail("cannot be read");
  }

  TetrahedronMesh read() {
    std::string word;
    while (stream_ >> word) {
      if (word == "$MeshFormat") format();
      if (word == "$Nodes") nodes();
      if (word == "$Elements") elements();
    }
    if (mesh_.cells.empty()) fail("holds no four-node tetrahedra");
    for (std::size_t k = 0; k < mesh_.cells.size(); ++k) {
      Tetrahedron& cell = mesh_.cells[k];
      const double size = volume(mesh_.vertices, cell);
      double longest = 0;
      for (const int a : cell) {
        for (const int b : cell) longest = std::max(longest, (mesh_.vertices[a] - mesh_.vertices[b]).norm());
      }
      if (!(std::abs(size) > 1e-12 * longest * longest * longest))
        fail("tetrahedron " + std::to_string(k) + " has no volume");
      if (size < 0) std::swap(cell[2], cell[3]);
    }
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& text) const { throw MeshError(name_ + ": " + text); }

  template <class Number>
  Number take(const char* what) {
    Number number;
    if (!(stream_ >> number)) fail(std::string("ends or is damaged where ") + what + " was expected");
    return number;
  }

  void format() {
    const auto version = take<double>("a version");
    const int binary = take<int>("a file type");
    if (version < 2 || version >= 3 || binary != 0)
      fail("is another kind of Gmsh file, allowed: version 2.2, ASCII (gmsh -format msh22)");
    known_ = true;
  }

  void nodes() {
    if (!known_) fail("has no $MeshFormat before $Nodes");
    for (auto left = take<long>("a number of nodes"); left > 0; --left) {
      const auto id = take<long>("a node");
      Vector3& x = points_[id];
      for (double& coordinate : x) coordinate = take<double>("a coordinate");
      if (!x.allFinite()) fail("node " + std::to_string(id) + " is not finite");
    }
  }

  void elements() {
    for (auto left = take<long>("a number of elements"); left > 0; --left) {
      take<long>("an element");
      const int type = take<int>("its type");
      for (int tags = take<int>("its number of tags"); tags > 0; --tags) take<long>("a tag");
      std::string rest;
      if (type != 4) {
        std::getline(stream_, rest);
        continue;
      }
      Tetrahedron cell;
      for (int& corner : cell) corner = vertex(take<long>("a node of a tetrahedron"));
      mesh_.cells.push_back(cell);
    }
  }

  int vertex(long id) {
    const auto point = points_.find(id);
    if (point == points_.end()) fail("a tetrahedron has the node " + std::to_string(id) + ", which is not there");
    const auto [at, is_new] = numbers_.try_emplace(id, static_cast<int>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(point->second);
    return at->second;
  }

  std::string name_;
  std::ifstream stream_;
  bool known_ = false;
  std::map<long, Vector3> points_;
  std::map<long, int> numbers_;
  TetrahedronMesh mesh_;
};

}  // namespace

TetrahedronMesh read_tetrahedra(const std::filesystem::path& file) { return MshReader(file).read(); }

std::vector<Triangle> boundary_triangles(const std::vector<Tetrahedron>& cells) {
  std::map<Triangle, std::pair<int, Triangle>> faces;  // how often, and as its first cell has it
  for (const Tetrahedron& c : cells) {
    for (const Triangle& face : {Triangle{c[0], c[2], c[1]}, Triangle{c[0], c[1], c[3]}, Triangle{c[1], c[2], c[3]},
                                 Triangle{c[2], c[0], c[3]}}) {
      Triangle key = face;
      std::sort(key.begin(), key.end());
      auto& [count, first] = faces.try_emplace(key, 0, face).first->second;
      ++count;
    }
  }
  std::vector<Triangle> boundary;
  for (const auto& [key, face] : faces) {
    if (face.first == 1) boundary.push_back(face.second);
  }
  return boundary;
}

TetrahedronMesh make_box(const Vector3& size, int cells_x, int cells_y, int cells_z) {
  TetrahedronMesh mesh;
  const auto node = [&](int i, int j, int k) { return (k * (cells_y + 1) + j) * (cells_x + 1) + i; };
  for (int k = 0; k <= cells_z; ++k) {
    for (int j = 0; j <= cells_y; ++j) {
      for (int i = 0; i <= cells_x; ++i)
        mesh.vertices.emplace_back(size.x() * i / cells_x, size.y() * j / cells_y, size.z() * k / cells_z);
    }
  }
  // From corner to corner along the axes in each of their orders; odd orders are turned.
  constexpr std::array<std::array<int, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (int k = 0; k < cells_z; ++k) {
    for (int j = 0; j < cells_y; ++j) {
      for (int i = 0; i < cells_x; ++i) {
        for (std::size_t order = 0; order < orders.size(); ++order) {
          std::array<int, 3> at{i, j, k};
          Tetrahedron cell{node(i, j, k)};
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(orders[order][step])];
            cell[step + 1] = node(at[0], at[1], at[2]);
          }
          if (order >= 3) std::swap(cell[2], cell[3]);
          mesh.cells.push_back(cell);
        }
      }
    }
  }
  return mesh;
}

}  // namespace taut
