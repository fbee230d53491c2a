#include "geometry/prolongation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <numeric>

#include "geometry/grid.h"
#include "geometry/measures.h"
#include "support/meshes.h"
#include "support/random_values.h"

namespace taut {
namespace {

using testing::HasSubstr;

/// P^T Q is zero and [P Q] regular; the condition number of Q is returned.
double check_basis(const TriangleMesh& coarse, const Prolongation& p) {
  const SparseMatrix q = complementary_basis(coarse, p, "fine");
  EXPECT_EQ(q.cols(), p.weights.rows() - p.weights.cols());
  const Matrix product = Matrix(p.weights).transpose() * Matrix(q);
  EXPECT_LE(product.size() == 0 ? 0.0 : product.lpNorm<Eigen::Infinity>(), 1e-13);
  Matrix both(p.weights.rows(), p.weights.rows());
  both << Matrix(p.weights), Matrix(q);
  EXPECT_EQ(Eigen::ColPivHouseholderQR<Matrix>(both).rank(), p.weights.rows());
  if (q.cols() == 0) return 1;
  const Vector values = Eigen::JacobiSVD<Matrix>(Matrix(q)).singularValues();
  return values[0] / values[values.size() - 1];
}

TriangleMesh coarse_grid() { return make_grid(1, 1, 4, 4, Diagonals::alternating); }

/// Points of a finer grid of which no vertex but the corners meets one of the coarse grid's.
std::vector<Vector3> other_grid(int cells) { return make_grid(1, 1, cells, cells, Diagonals::right).vertices; }

std::vector<Vector3> jittered(double amplitude) {
  const TriangleMesh fine = refine(coarse_grid(), 2).first;
  RandomValues random(7);
  return mapped(fine.vertices, [&](const Vector3& v) -> Vector3 {
    return v + amplitude * Vector3(random.value(), random.value(), 0);
  });
}

TEST(Refine, KeepsTheAreaAndPutsTheCoarseVerticesFirst) {
  const TriangleMesh coarse = coarse_grid();
  const auto [fine, p] = refine(coarse, 3);
  EXPECT_EQ(fine.vertices.size(), 33u * 33u);
  EXPECT_EQ(fine.triangles.size(), coarse.triangles.size() * 64);
  const std::vector<double> areas = triangle_areas(fine);
  EXPECT_NEAR(std::accumulate(areas.begin(), areas.end(), 0.0), 1, 1e-13);
  EXPECT_TRUE(std::equal(coarse.vertices.begin(), coarse.vertices.end(), fine.vertices.begin()));
  EXPECT_NO_THROW(validate(fine, "fine"));
}

TEST(Refine, InterpolatesItsOwnVertices) {
  for (const TriangleMesh& coarse : {coarse_grid(), octahedron()}) {
    const auto [fine, p] = refine(coarse, 3);
    const std::vector<Vector3> interpolated = prolonged(p, coarse.vertices);
    for (std::size_t i = 0; i < fine.vertices.size(); ++i)
      EXPECT_LE((interpolated[i] - fine.vertices[i]).norm(), 1e-15);
    EXPECT_TRUE(is_closed(fine) == is_closed(coarse));
  }
}

TEST(Refine, ExtendsGroups) {
  TriangleMesh coarse = coarse_grid();
  coarse.groups["left"] = {0, 5, 10, 15, 20};
  const TriangleMesh fine = refine(coarse, 2).first;
  EXPECT_EQ(fine.groups.at("left").size(), 17u);
  for (const int v : fine.groups.at("left")) EXPECT_EQ(fine.vertices[v].x(), 0);
}

TEST(Prolongation, OfANestedMeshIsThatOfTheRefinement) {
  const TriangleMesh coarse = octahedron();
  const auto [fine, nested] = refine(coarse, 3);
  const Prolongation closest = prolongation(coarse, fine.vertices, "fine");
  EXPECT_LE((Matrix(closest.weights) - Matrix(nested.weights)).lpNorm<Eigen::Infinity>(), 1e-9);
  EXPECT_EQ(closest.weights.nonZeros(), nested.weights.nonZeros());
}

TEST(Prolongation, ReproducesPointsOfThePlaneOutsideTheCoarseMeshToo) {
  const TriangleMesh coarse = coarse_grid();
  const auto points =
      mapped(other_grid(11), [](const Vector3& v) -> Vector3 { return 1.04 * v - Vector3(.02, .02, 0); });
  const Prolongation p = prolongation(coarse, points, "fine");
  const std::vector<Vector3> interpolated = prolonged(p, coarse.vertices);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LE((interpolated[i] - points[i]).norm(), 1e-14);
  EXPECT_LT(Matrix(p.weights).minCoeff(), -0.01);
  check_basis(coarse, p);
}

TEST(Prolongation, KnowsTheDistanceOfAPoint) {
  std::vector<Vector3> points = refine(coarse_grid(), 1).first.vertices;
  points[30].z() = 0.125;
  EXPECT_DOUBLE_EQ(prolongation(coarse_grid(), points, "fine").anchors[30].distance, 0.125);
}

std::string refusal(const std::vector<Vector3>& points) {
  try {
    const TriangleMesh coarse = coarse_grid();
    right_inverse(coarse, prolongation(coarse, points, "fine.obj"), "fine.obj");
  } catch (const MeshError& error) {
    return error.what();
  }
  return "";
}

TEST(Prolongation, RefusesACoarseVertexThatNoPointSees) {
  std::vector<Vector3> points = refine(coarse_grid(), 2).first.vertices;
  std::erase_if(points, [](const Vector3& v) { return v.x() > 0.75 || v.y() > 0.75; });
  EXPECT_THAT(refusal(points), HasSubstr("fine.obj: none of its points is in a triangle of vertex 4 "));
}

TEST(Prolongation, RefusesPointsAtTheSamePlace) {
  std::vector<Vector3> points = refine(coarse_grid(), 1).first.vertices;
  points.push_back(points[12]);
  EXPECT_THAT(refusal(points), HasSubstr("vertices 12 and 81 are at the same place"));
}

TEST(Prolongation, RefusesARankDeficientCoupling) {
  // Vertices 11 and 12 share one point.
  std::vector<Vector3> points = coarse_grid().vertices;
  points[11] = 0.5 * (points[11] + points[12]);
  points.erase(points.begin() + 12);
  EXPECT_THAT(refusal(points),
              HasSubstr("vertex 11 of the coarse mesh from that of its neighbours (P is rank deficient)"));
}

TEST(Prolongation, RefusesASumOfWeightsThatIsNotPositive) {
  std::vector<Vector3> points = refine(coarse_grid(), 1).first.vertices;
  std::erase_if(points, [](const Vector3& v) { return v.x() > 0.8 && v.y() > 0.8; });
  points.emplace_back(0.9, -2.0, 0);
  points.emplace_back(2.0, -2.0, 0);
  EXPECT_THAT(refusal(points), HasSubstr("sum to -"));
}

class NestedBasis : public testing::TestWithParam<int> {};
TEST_P(NestedBasis, IsOrthogonalAndComplete) {
  const auto [fine, p] = refine(coarse_grid(), GetParam());
  check_basis(coarse_grid(), p);
}
INSTANTIATE_TEST_SUITE_P(Levels, NestedBasis, testing::Values(0, 1, 2, 3));

TEST(ComplementaryBasis, OfAClosedMesh) { check_basis(octahedron(), refine(octahedron(), 2).second); }

TEST(ComplementaryBasis, OfJitteredPoints) {
  for (const double amplitude : {1e-12, 1e-7, 0.01, 0.03})
    EXPECT_LE(check_basis(coarse_grid(), prolongation(coarse_grid(), jittered(amplitude), "fine")), 20);
}

TEST(ComplementaryBasis, OfShrunkMeshes) {
  for (const int levels : {1, 2}) {
    const auto points = mapped(refine(coarse_grid(), levels).first.vertices, [](const Vector3& v) -> Vector3 {
      return Vector3(0.5, 0.5, 0) + 0.93 * (v - Vector3(0.5, 0.5, 0));
    });
    check_basis(coarse_grid(), prolongation(coarse_grid(), points, "fine"));
  }
}

TEST(ComplementaryBasis, OfPointsInAnyOrder) {
  std::vector<Vector3> points = refine(coarse_grid(), 2).first.vertices;
  std::reverse(points.begin(), points.end());
  std::rotate(points.begin(), points.begin() + 40, points.end());
  check_basis(coarse_grid(), prolongation(coarse_grid(), points, "fine"));
}

TEST(ComplementaryBasis, OfMeshesThatAreNotNested) {
  for (const int cells : {5, 6, 7, 11, 13, 16})
    check_basis(coarse_grid(), prolongation(coarse_grid(), other_grid(cells), "fine"));
}

/// The basis of [MLTS 2.3], as printed, for one coordinate.
SparseMatrix printed_basis(Index fine, const std::vector<Triangle>& indices, const std::vector<Vector2>& weights) {
  std::vector<Eigen::Triplet<double>> entries;
  std::map<int, int> y_to_x;
  int nz = 0;
  for (int x = 0; x < static_cast<int>(fine); ++x) {
    const double w1 = weights[x][0], w2 = weights[x][1], w0 = 1 - w1 - w2;
    if (w1 != 0 || w2 != 0) {
      if (w0 != 0) entries.emplace_back(y_to_x[indices[x][0]], nz, -w0);
      if (w1 != 0) entries.emplace_back(y_to_x[indices[x][1]], nz, -w1);
      if (w2 != 0) entries.emplace_back(y_to_x[indices[x][2]], nz, -w2);
      entries.emplace_back(x, nz, 1.0);
      ++nz;
    } else {
      y_to_x[indices[x][0]] = x;
    }
  }
  SparseMatrix q(fine, nz);
  q.setFromTriplets(entries.begin(), entries.end());
  return q;
}

/// The input that the printed code takes, for a nested refinement, with coincident points given as `corner` of their
/// triangle.
struct PrintedInput {
  TriangleMesh coarse = coarse_grid();
  Prolongation p = refine(coarse, 2).second;
  std::vector<Triangle> indices;
  std::vector<Vector2> weights;

  explicit PrintedInput(int corner) {
    for (const Anchor& anchor : p.anchors) {
      const Triangle& t = coarse.triangles[anchor.triangle];
      int first = 0;
      for (int k = 0; k < 3; ++k) {
        if (anchor.weights[k] == 1) first = (k - corner + 3) % 3;
      }
      indices.push_back({t[first], t[(first + 1) % 3], t[(first + 2) % 3]});
      weights.emplace_back(anchor.weights[(first + 1) % 3], anchor.weights[(first + 2) % 3]);
    }
  }
  void move(std::size_t from, std::size_t to) {
    const auto turn = [&](auto& list) {
      auto value = list[from];
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(from));
      list.insert(list.begin() + static_cast<std::ptrdiff_t>(to), value);
    };
    turn(indices);
    turn(weights);
    turn(p.anchors);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      for (int k = 0; k < 3; ++k)
        entries.emplace_back(static_cast<int>(i), coarse.triangles[p.anchors[i].triangle][k], p.anchors[i].weights[k]);
    }
    p.weights.setFromTriplets(entries.begin(), entries.end());
    p.weights.prune(0.0);
  }
  SparseMatrix printed() const { return printed_basis(p.weights.rows(), indices, weights); }
  double product() const { return (Matrix(p.weights).transpose() * Matrix(printed())).lpNorm<Eigen::Infinity>(); }
};

TEST(PrintedBasis, IsOursWhereItsAssumptionsHold) {
  const PrintedInput input(0);
  EXPECT_LE(input.product(), 1e-15);
  const Matrix difference = Matrix(input.printed()) - Matrix(complementary_basis(input.coarse, input.p, "fine"));
  EXPECT_EQ(difference.lpNorm<Eigen::Infinity>(), 0);
}

TEST(PrintedBasis, FailsWhereACoincidentPointComesLaterAndOursDoesNot) {
  PrintedInput input(0);
  input.move(6, input.indices.size() - 1);
  EXPECT_GT(input.product(), 0.5);
  check_basis(input.coarse, input.p);
}

TEST(PrintedBasis, FailsWhereACoincidentPointHasItsWeightElsewhereAndOursDoesNot) {
  const PrintedInput input(1);
  EXPECT_GE(input.product(), 1);
  EXPECT_GT(input.printed().cols(), input.p.weights.rows() - input.p.weights.cols());
  check_basis(input.coarse, input.p);
}

TEST(PrintedBasis, FailsAtATinyWeightAndOursSnapsIt) {
  PrintedInput input(0);
  input.weights[6][0] = 1e-17;
  EXPECT_GE(input.product(), 1 - 1e-12);
  check_basis(input.coarse, prolongation(input.coarse, jittered(1e-15), "fine"));
}

TEST(PrintedBasis, FreezesADuplicatePointWhereOursSeesIt) {
  PrintedInput input(0);
  // A second fine point at coarse vertex 6: P^T Q = 0 still, but a column is missing.
  input.indices.push_back(input.indices[6]);
  input.weights.push_back(input.weights[6]);
  input.p.anchors.push_back(input.p.anchors[6]);
  input.p.weights.conservativeResize(input.p.weights.rows() + 1, input.p.weights.cols());
  input.p.weights.insert(input.p.weights.rows() - 1, 6) = 1;
  EXPECT_LT(input.printed().cols(), input.p.weights.rows() - input.p.weights.cols());
  check_basis(input.coarse, input.p);
}

}  // namespace
}  // namespace taut
