#include "geometry/prolongation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include "geometry/distance.h"
#include "geometry/measures.h"

namespace taut {
namespace {

constexpr double snap = 1e-9;

/// Weights that are exactly what they nearly are.
Vector3 snapped(Vector3 weights) {
  for (double& w : weights) {
    if (std::abs(w) < snap) w = 0;
  }
  for (int k = 0; k < 3; ++k) {
    if (weights[(k + 1) % 3] == 0 && weights[(k + 2) % 3] == 0) return Vector3::Unit(k);
  }
  int largest = 0;
  weights.cwiseAbs().maxCoeff(&largest);
  weights[largest] = 1 - weights[(largest + 1) % 3] - weights[(largest + 2) % 3];
  return weights;
}

SparseMatrix matrix_of(const TriangleMesh& coarse, const std::vector<Anchor>& anchors) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const Triangle& triangle = coarse.triangles[static_cast<std::size_t>(anchors[i].triangle)];
    for (int k = 0; k < 3; ++k) {
      if (anchors[i].weights[k] != 0) entries.emplace_back(static_cast<int>(i), triangle[k], anchors[i].weights[k]);
    }
  }
  SparseMatrix matrix(static_cast<Index>(anchors.size()), static_cast<Index>(coarse.vertices.size()));
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// One division of every triangle into four; anchors are those in the coarsest mesh.
void divide(TriangleMesh& mesh, std::vector<Anchor>& anchors, std::vector<int>& roots, const TriangleMesh& coarse) {
  std::map<std::pair<int, int>, int> middles;
  std::vector<Triangle> triangles;
  std::vector<int> new_roots;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle corners = mesh.triangles[t];
    const Triangle& root = coarse.triangles[static_cast<std::size_t>(roots[t])];
    // Corners of the root have anchors in any of its neighbours; here they count in the root itself.
    const auto weights_in_root = [&](int vertex) -> Vector3 {
      const Anchor& anchor = anchors[static_cast<std::size_t>(vertex)];
      const Triangle& own = coarse.triangles[static_cast<std::size_t>(anchor.triangle)];
      Vector3 weights = Vector3::Zero();
      for (int k = 0; k < 3; ++k) {
        const auto at = std::find(root.begin(), root.end(), own[k]) - root.begin();
        if (at < 3) weights[at] = anchor.weights[k];
      }
      return weights;
    };
    Triangle middle{};
    for (int k = 0; k < 3; ++k) {
      const int a = corners[k], b = corners[(k + 1) % 3];
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(mesh.vertices.size()));
      middle[k] = at->second;
      if (!is_new) continue;
      mesh.vertices.push_back(0.5 * (mesh.vertices[a] + mesh.vertices[b]));
      anchors.push_back({roots[t], 0.5 * (weights_in_root(a) + weights_in_root(b)), 0});
    }
    triangles.push_back({corners[0], middle[0], middle[2]});
    triangles.push_back({middle[0], corners[1], middle[1]});
    triangles.push_back({middle[2], middle[1], corners[2]});
    triangles.push_back(middle);
    new_roots.insert(new_roots.end(), 4, roots[t]);
  }
  for (auto& [name, group] : mesh.groups) {
    std::vector<int> more;
    for (const auto& [edge, middle] : middles) {
      if (std::binary_search(group.begin(), group.end(), edge.first) &&
          std::binary_search(group.begin(), group.end(), edge.second))
        more.push_back(middle);
    }
    std::sort(more.begin(), more.end());
    group.insert(group.end(), more.begin(), more.end());
  }
  mesh.triangles = std::move(triangles);
  roots = std::move(new_roots);
}

void refuse_duplicates(const std::vector<Vector3>& points, const std::string& label) {
  Vector3 low = points.front(), high = points.front();
  for (const Vector3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  const double close = snap * (high - low).norm();
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return points[a].x() < points[b].x(); });
  for (std::size_t i = 0; i < order.size(); ++i) {
    for (std::size_t j = i + 1; j < order.size() && points[order[j]].x() - points[order[i]].x() <= close; ++j) {
      if ((points[order[j]] - points[order[i]]).norm() > close) continue;
      throw MeshError(label + ": vertices " + std::to_string(std::min(order[i], order[j])) + " and " +
                      std::to_string(std::max(order[i], order[j])) +
                      " are at the same place, where one could not "
                      "follow the coarse mesh without the other");
    }
  }
}

void check_sums(const SparseMatrix& weights, const std::string& label) {
  for (Index k = 0; k < weights.cols(); ++k) {
    const double sum = weights.col(k).sum();
    if (weights.col(k).nonZeros() == 0)
      throw MeshError(label + ": none of its points is in a triangle of vertex " + std::to_string(k) +
                      " of the coarse mesh (or on the far edge only), which nothing would couple; refine it there");
    if (!(sum > 0))
      throw MeshError(label + ": the weights of its points at vertex " + std::to_string(k) +
                      " of the coarse mesh sum to " + std::to_string(sum) +
                      ", allowed: a positive number (points far outside have negative weights)");
  }
}

/// Which sides of each triangle are at the boundary; side k is opposite to corner k.
std::vector<std::array<bool, 3>> boundary_sides(const TriangleMesh& mesh) {
  std::vector<std::array<bool, 3>> sides(mesh.triangles.size(), {false, false, false});
  for (const Edge& edge : edges(mesh)) {
    if (edge.right >= 0) continue;
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(edge.left)];
    for (int k = 0; k < 3; ++k) {
      if (t[k] == edge.opposite_left) sides[static_cast<std::size_t>(edge.left)][k] = true;
    }
  }
  return sides;
}

/// Barycentric coordinates of the projection onto the triangle's plane.
Vector3 plane_weights(const Vector3& point, const Vector3& a, const Vector3& b, const Vector3& c) {
  Matrix32 sides;
  sides << b - a, c - a;
  const Vector2 uv = (sides.transpose() * sides).ldlt().solve(sides.transpose() * (point - a));
  return {1 - uv.sum(), uv[0], uv[1]};
}

}  // namespace

std::pair<TriangleMesh, Prolongation> refine(const TriangleMesh& coarse, int levels) {
  if (levels < 0 || levels > 8)
    throw std::invalid_argument("refine: levels is " + std::to_string(levels) + ", expected 0 to 8");
  TriangleMesh mesh = coarse;
  mesh.cells_x = mesh.cells_y = 0;
  mesh.corner_uv.clear();
  std::vector<Anchor> anchors(coarse.vertices.size());
  std::vector<int> roots(coarse.triangles.size());
  std::iota(roots.begin(), roots.end(), 0);
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) anchors[coarse.triangles[t][k]] = {static_cast<int>(t), Vector3::Unit(k), 0};
  }
  for (int level = 0; level < levels; ++level) divide(mesh, anchors, roots, coarse);
  SparseMatrix weights = matrix_of(coarse, anchors);
  return {std::move(mesh), {std::move(weights), std::move(anchors)}};
}

Prolongation prolongation(const TriangleMesh& coarse, const std::vector<Vector3>& points, const std::string& label) {
  if (points.empty()) throw MeshError(label + ": no points");
  refuse_duplicates(points, label);
  const std::vector<std::array<bool, 3>> boundary = boundary_sides(coarse);
  const std::vector<int> nearest = nearest_triangles(coarse, points);
  Prolongation result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Triangle& t = coarse.triangles[static_cast<std::size_t>(nearest[i])];
    const Vector3 &a = coarse.vertices[t[0]], &b = coarse.vertices[t[1]], &c = coarse.vertices[t[2]];
    const TriangleDistance at = point_triangle_distance(points[i], a, b, c);
    Vector3 weights = at.weights;
    const Vector3 open = plane_weights(points[i], a, b, c);
    bool beside_boundary = false;
    for (int k = 0; k < 3; ++k) {
      if (open[k] < -snap) beside_boundary = beside_boundary || boundary[static_cast<std::size_t>(nearest[i])][k];
    }
    if (beside_boundary) weights = open;
    result.anchors.push_back({nearest[i], snapped(weights), at.distance});
  }
  result.weights = matrix_of(coarse, result.anchors);
  check_sums(result.weights, label);
  return result;
}

std::vector<Vector3> prolonged(const Prolongation& prolongation, const std::vector<Vector3>& coarse) {
  Eigen::MatrixX3d values(static_cast<Index>(coarse.size()), 3);
  for (std::size_t k = 0; k < coarse.size(); ++k) values.row(static_cast<Index>(k)) = coarse[k].transpose();
  const Eigen::MatrixX3d fine = prolongation.weights * values;
  std::vector<Vector3> points;
  for (Index i = 0; i < fine.rows(); ++i) points.push_back(fine.row(i).transpose());
  return points;
}

#ifndef TAUT_WITH_CGAL
std::vector<int> nearest_triangles(const TriangleMesh& mesh, const std::vector<Vector3>& points) {
  std::vector<int> nearest;
  for (const Vector3& point : points) {
    double least = std::numeric_limits<double>::infinity();
    nearest.push_back(0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle& c = mesh.triangles[t];
      const double distance =
          point_triangle_distance(point, mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]).distance;
      if (distance >= least) continue;
      least = distance;
      nearest.back() = static_cast<int>(t);
    }
  }
  return nearest;
}
#endif

}  // namespace taut
