#include "constraints/coupling.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <numeric>

#include "geometry/grid.h"
#include "support/meshes.h"
#include "support/random_values.h"

namespace taut {
namespace {

/// A refined grid whose vertices follow one node each, or the mean of two; a node before and one behind that is
/// neither.
CoupledMeshes coupled(const TriangleMesh& coarse, const Prolongation& p, int nodes_each) {
  CoupledMeshes meshes;
  meshes.name = "coupling";
  meshes.coarse_name = "shell";
  meshes.prolongation = &p;
  int node = 1;
  for (std::size_t v = 0; v < coarse.vertices.size(); ++v) {
    meshes.coarse_nodes.emplace_back();
    for (int k = 0; k < nodes_each; ++k) meshes.coarse_nodes.back().push_back(node++);
  }
  meshes.first_fine_node = node;
  meshes.nodes = node + p.weights.rows() + 1;
  meshes.invisible = complementary_basis(coarse, p, "fine");
  return meshes;
}

class Coupling : public testing::TestWithParam<int> {
 protected:
  const TriangleMesh coarse_ = make_grid(1, 1, 3, 3, Diagonals::alternating);
  const Prolongation p_ = refine(coarse_, 2).second;
};

TEST_P(Coupling, IsZeroWhereTheFineMeshFollowsAndSeesWhereItDoesNot) {
  const CoupledMeshes meshes = coupled(coarse_, p_, GetParam());
  const LinearEqualities equal = couple(meshes);
  Vector x = RandomValues(2).vector(3 * meshes.nodes);
  std::vector<Vector3> surface;
  for (const std::vector<int>& nodes : meshes.coarse_nodes) {
    surface.push_back(Vector3::Zero());
    for (const int node : nodes) surface.back() += x.segment<3>(3 * node) / static_cast<double>(nodes.size());
  }
  const std::vector<Vector3> fine = prolonged(p_, surface);
  for (std::size_t i = 0; i < fine.size(); ++i)
    x.segment<3>(3 * (meshes.first_fine_node + static_cast<Index>(i))) = fine[i];
  EXPECT_LE((equal.rows * x).lpNorm<Eigen::Infinity>(), 1e-15);
  // A shift of the whole membrane is seen as it is by every row.
  for (std::size_t i = 0; i < fine.size(); ++i) x[3 * (meshes.first_fine_node + static_cast<Index>(i)) + 2] += 0.25;
  const Vector off = equal.rows * x;
  for (Index row = 0; row < off.size(); ++row) EXPECT_NEAR(off[row], row % 3 == 2 ? 0.25 : 0, 1e-15);
  EXPECT_EQ(equal.row_name(7), "vertex 2 of shell, y");
}

TEST_P(Coupling, HasTheNullSpaceOfTheChangeOfVariables) {
  const LinearEqualities equal = couple(coupled(coarse_, p_, GetParam()));
  EXPECT_LE(Matrix(equal.rows * equal.null_space).lpNorm<Eigen::Infinity>(), 1e-14);
  EXPECT_EQ(equal.null_space.cols(), equal.rows.cols() - equal.rows.rows());
  EXPECT_EQ(Eigen::ColPivHouseholderQR<Matrix>(Matrix(equal.null_space)).rank(), equal.null_space.cols());
}

TEST_P(Coupling, ForcesOnBothBodiesCancel) {
  const LinearEqualities equal = couple(coupled(coarse_, p_, GetParam()));
  const Vector force = equal.rows.transpose() * RandomValues(9).vector(equal.rows.rows());
  Vector3 sum = Vector3::Zero();
  for (Index node = 0; node < force.size() / 3; ++node) sum += force.segment<3>(3 * node);
  EXPECT_LE(sum.norm(), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(NodesOfAVertex, Coupling, testing::Values(1, 2));

TEST(MakeCompatible, TakesAwayWhatTheCoarseMeshSeesAndNothingElse) {
  const TriangleMesh coarse = make_grid(1, 1, 3, 3, Diagonals::alternating);
  const auto [fine, p] = refine(coarse, 2);
  RandomValues random(3);
  std::vector<Vector3> points = fine.vertices;
  for (Vector3& point : points) point += 0.1 * Vector3(random.vector(3));
  make_compatible(p, coarse.vertices, points);
  const std::vector<Vector3> once = points;
  Vector off = Vector::Zero(p.weights.cols());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (Index k = 0; k < off.size(); ++k)
      off[k] += p.weights.coeff(static_cast<Index>(i), k) * (points[i] - fine.vertices[i]).z();
  }
  EXPECT_LE(off.lpNorm<Eigen::Infinity>(), 1e-14);
  make_compatible(p, coarse.vertices, points);
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_LE((points[i] - once[i]).norm(), 1e-14);
}

}  // namespace
}  // namespace taut
