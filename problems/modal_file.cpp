#include "problems/modal_file.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "files/checkpoint.h"
#include "problems/hash.h"

namespace taut {
namespace {

constexpr const char* kind = "modal basis";

std::vector<double> array(const Matrix& matrix) { return {matrix.data(), matrix.data() + matrix.size()}; }

Matrix matrix_of(const Checkpoint& file, const char* name, Index rows, Index columns) {
  const std::vector<double>& values = file.arrays.at(name);
  if (static_cast<Index>(values.size()) != rows * columns) throw std::out_of_range(name);
  Matrix matrix = Eigen::Map<const Matrix>(values.data(), rows, columns);
  if (!matrix.allFinite()) throw std::out_of_range(name);
  return matrix;
}

ModalBasis basis_from(const Checkpoint& file) {
  ModalBasis basis;
  const auto modes = static_cast<Index>(file.arrays.at("eigenvalues").size());
  const auto size = static_cast<Index>(file.arrays.at("rest").size());
  basis.rest = matrix_of(file, "rest", size, 1);
  basis.shapes = matrix_of(file, "shapes", size, modes);
  basis.rotations = matrix_of(file, "rotations", size, modes);
  basis.eigenvalues = matrix_of(file, "eigenvalues", modes, 1);
  basis.residuals = matrix_of(file, "residuals", modes, 1);
  basis.rigid = static_cast<int>(file.step);
  basis.mesh_hash = file.input_hash;
  basis.body_hash = file.texts.at("body");
  return basis;
}

}  // namespace

std::string hash_of_mesh(const Vector& positions, const std::vector<Triangle>& triangles,
                         const std::vector<Tetrahedron>& tetrahedra) {
  std::string bytes(reinterpret_cast<const char*>(positions.data()),
                    static_cast<std::size_t>(positions.size()) * sizeof(double));
  bytes.append(reinterpret_cast<const char*>(triangles.data()), triangles.size() * sizeof(Triangle));
  bytes.append(reinterpret_cast<const char*>(tetrahedra.data()), tetrahedra.size() * sizeof(Tetrahedron));
  return fnv1a(bytes);
}

std::string hash_of_body(const Scene& scene) {
  nlohmann::json body = nlohmann::json::parse(scene.document)["bodies"].begin().value();
  for (const char* key : {"mesh", "transform", "top", "damping", "initial_velocity"}) body.erase(key);
  for (const char* key : {"modes", "damping_ratio", "rotation", "basis"}) body["modal"].erase(key);
  return fnv1a(body.dump());
}

void write_basis(const std::filesystem::path& path, const ModalBasis& basis) {
  Checkpoint file;
  file.input_hash = basis.mesh_hash;
  file.step = basis.rigid;
  file.arrays = {{"rest", array(basis.rest)},
                 {"shapes", array(basis.shapes)},
                 {"rotations", array(basis.rotations)},
                 {"eigenvalues", array(basis.eigenvalues)},
                 {"residuals", array(basis.residuals)}};
  file.texts = {{"kind", kind}, {"body", basis.body_hash}};
  write_checkpoint(path, file);
}

ModalBasis read_basis(const std::filesystem::path& path, const std::string& mesh_hash, const std::string& body_hash) {
  const Checkpoint file = read_checkpoint(path);
  const auto found = file.texts.find("kind");
  if (found == file.texts.end() || found->second != kind) throw FileError(path, "holds no modal basis");
  if (file.input_hash != mesh_hash) {
    throw FileError(path, "holds the modes of another mesh (its hash is " + file.input_hash + ", that of this one " +
                              mesh_hash + ")");
  }
  if (file.texts.at("body") != body_hash) {
    throw FileError(path, "holds the modes of another material, mass or clamp (its hash is " + file.texts.at("body") +
                              ", that of this one " + body_hash + ")");
  }
  try {
    return basis_from(file);
  } catch (const std::out_of_range& error) {
    throw FileError(path, std::string("damaged modal basis: ") + error.what());
  }
}

}  // namespace taut
