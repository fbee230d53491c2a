#include "dynamics/model.h"

#include "dynamics/modal/modal_basis.h"
#include "dynamics/modal/modal_energies.h"

namespace taut {

Model::Model() = default;
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

Vector Model::vertex_positions(const Vector& x) const { return modal ? modal->positions(x) : x; }

Vector Model::vertex_velocities(const Vector& x, const Vector& v) const { return modal ? modal->velocities(x, v) : v; }

}  // namespace taut
