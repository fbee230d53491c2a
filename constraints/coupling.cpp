#include "constraints/coupling.h"

#include <Eigen/SparseCholesky>
#include <numeric>
#include <stdexcept>

namespace taut {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

SparseMatrix from_triplets(Index rows, Index columns, const Triplets& entries) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// matrix x I_3, with a place for each row and column.
template <class Row, class Column>
void append_for_axes(const SparseMatrix& matrix, const Row& row, const Column& column, Triplets& entries) {
  for (Index k = 0; k < matrix.outerSize(); ++k) {
    for (SparseMatrix::InnerIterator entry(matrix, k); entry; ++entry) {
      for (int axis = 0; axis < 3; ++axis)
        entries.emplace_back(static_cast<int>(3 * row(entry.row()) + axis),
                             static_cast<int>(3 * column(entry.col()) + axis), entry.value());
    }
  }
}

/// S: coarse vertices x nodes of the scene.
SparseMatrix surface_of(const CoupledMeshes& meshes) {
  Triplets entries;
  for (std::size_t v = 0; v < meshes.coarse_nodes.size(); ++v) {
    const std::vector<int>& nodes = meshes.coarse_nodes[v];
    for (const int node : nodes)
      entries.emplace_back(static_cast<int>(v), node, 1.0 / static_cast<double>(nodes.size()));
  }
  return from_triplets(static_cast<Index>(meshes.coarse_nodes.size()), meshes.nodes, entries);
}

SparseMatrix null_space_of(const CoupledMeshes& meshes, const SparseMatrix& surface) {
  const SparseMatrix& p = meshes.prolongation->weights;
  const Index fine = p.rows(), others = meshes.nodes - fine, first = meshes.first_fine_node;
  const auto column_of = [&](Index node) { return node < first ? node : node - fine; };
  Triplets entries;
  for (Index node = 0; node < meshes.nodes; ++node) {
    if (node >= first && node < first + fine) continue;
    for (int axis = 0; axis < 3; ++axis)
      entries.emplace_back(static_cast<int>(3 * node + axis), static_cast<int>(3 * column_of(node) + axis), 1.0);
  }
  const auto fine_node = [&](Index i) { return first + i; };
  append_for_axes(p * surface, fine_node, column_of, entries);
  append_for_axes(
      meshes.invisible, fine_node, [&](Index k) { return others + k; }, entries);
  return from_triplets(3 * meshes.nodes, 3 * (others + meshes.invisible.cols()), entries);
}

}  // namespace

LinearEqualities couple(const CoupledMeshes& meshes) {
  const SparseMatrix& p = meshes.prolongation->weights;
  if (static_cast<Index>(meshes.coarse_nodes.size()) != p.cols()) {
    throw std::invalid_argument("couple: nodes at " + std::to_string(meshes.coarse_nodes.size()) +
                                " coarse vertices, expected " + std::to_string(p.cols()));
  }
  const Vector sums = p.transpose() * Vector::Ones(p.rows());
  if (!(sums.minCoeff() > 0)) throw std::invalid_argument("couple: a sum of weights P^T 1 is not positive");
  const SparseMatrix means = sums.cwiseInverse().asDiagonal() * SparseMatrix(p.transpose());
  const SparseMatrix surface = surface_of(meshes);

  LinearEqualities equal;
  equal.name = meshes.name;
  equal.violation_scale = meshes.scene_size;
  Triplets entries;
  const auto same = [](Index k) { return k; };
  append_for_axes(
      means, same, [&](Index i) { return meshes.first_fine_node + i; }, entries);
  append_for_axes(SparseMatrix(means * p * surface) * -1.0, same, same, entries);
  equal.rows = from_triplets(3 * p.cols(), 3 * meshes.nodes, entries);
  equal.values = Vector::Zero(equal.rows.rows());
  equal.following.resize(static_cast<std::size_t>(3 * p.rows()));
  std::iota(equal.following.begin(), equal.following.end(), 3 * meshes.first_fine_node);
  equal.row_name = [name = meshes.coarse_name](Index row) {
    return "vertex " + std::to_string(row / 3) + " of " + name + ", " + "xyz"[row % 3];
  };
  if (meshes.invisible.size() > 0) equal.null_space = null_space_of(meshes, surface);
  return equal;
}

void make_compatible(const Prolongation& prolongation, const std::vector<Vector3>& surface,
                     std::vector<Vector3>& fine) {
  const SparseMatrix& p = prolongation.weights;
  const std::vector<Vector3> on_surface = prolonged(prolongation, surface);
  Eigen::MatrixX3d off(static_cast<Index>(fine.size()), 3);
  for (std::size_t i = 0; i < fine.size(); ++i) off.row(static_cast<Index>(i)) = (fine[i] - on_surface[i]).transpose();
  const Eigen::SimplicialLDLT<SparseMatrix> gram(SparseMatrix(p.transpose() * p));
  const Eigen::MatrixX3d seen = p * Eigen::MatrixX3d(gram.solve(Eigen::MatrixX3d(p.transpose() * off)));
  for (std::size_t i = 0; i < fine.size(); ++i) fine[i] -= seen.row(static_cast<Index>(i)).transpose();
}

}  // namespace taut
