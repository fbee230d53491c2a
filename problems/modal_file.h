#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dynamics/modal/modal_basis.h"
#include "files/file_error.h"
#include "geometry/tetrahedra.h"
#include "problems/scene.h"

namespace taut {

/// Names a mesh: a hash of the positions of its nodes, its triangles and its tetrahedra.
std::string hash_of_mesh(const Vector& positions, const std::vector<Triangle>& triangles,
                         const std::vector<Tetrahedron>& tetrahedra);

/// Names what the modes of the scene's only body depend on besides the mesh: its material, mass matrix and clamp.
std::string hash_of_body(const Scene& scene);

/// Writes a basis as a checkpoint file with its hashes (docs/reference/modal_files.md). Throws FileError.
void write_basis(const std::filesystem::path& path, const ModalBasis& basis);

/// Throws FileError where the file is damaged, is no basis, or is one of another mesh or body.
ModalBasis read_basis(const std::filesystem::path& path, const std::string& mesh_hash, const std::string& body_hash);

}  // namespace taut
