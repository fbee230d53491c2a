#include "study/peak_tension.h"

#include <algorithm>
#include <array>
#include <map>
#include <numbers>

#include "constraints/strain_limit.h"
#include "energies/membrane.h"
#include "linalg/svd3x2.h"
#include "linalg/symmetric2.h"

namespace taut {
namespace {

/// Rest-frame tensions of triangles, N/m. Frames of all energies and limits begin at the edge 0-1 of the triangle.
using Tensions = std::map<Triangle, Matrix2>;

void add(Tensions& tensions, const Triangle& triangle, const Matrix2& tension) {
  const auto [place, is_new] = tensions.emplace(triangle, tension);
  if (!is_new) place->second += tension;
}

Matrix3 corners(const RestTriangle& triangle, const Vector& x) {
  Matrix3 result;
  for (int j = 0; j < 3; ++j) result.col(j) = x.segment<3>(3 * triangle.vertices[static_cast<std::size_t>(j)]);
  return result;
}

/// From the nodal forces, whatever the law: the gradient is area F N shape^T, one node a column.
void add_membrane(const Membrane& membrane, const Vector& x, Tensions& tensions) {
  for (Index element = 0; element < membrane.stencils().count(); ++element) {
    const RestTriangle& triangle = membrane.triangles()[static_cast<std::size_t>(element)];
    const Matrix3 at = corners(triangle, x);
    Matrix3 gradient;
    membrane.evaluate(element, at.data(), gradient.data(), nullptr, Curvature::exact);
    const Matrix32 f = triangle.deformation_gradient(at.data());
    const Matrix2 metric = triangle.shape.transpose() * triangle.shape, c = f.transpose() * f;
    const Matrix32 first_kind = gradient * triangle.shape * metric.inverse() / triangle.area;
    add(tensions, triangle.vertices, c.inverse() * f.transpose() * first_kind);
  }
}

void add_limit(const StrainLimitTriangles& limit, const Vector& multipliers, bool matrix, const Vector& x,
               Tensions& tensions) {
  for (std::size_t e = 0; e < limit.triangles.size(); ++e) {
    const RestTriangle& triangle = limit.triangles[e];
    Matrix2 tension;
    if (matrix) {
      const auto row = multipliers.segment<3>(3 * static_cast<Index>(e));
      tension << row[0], row[1] / std::numbers::sqrt2, row[1] / std::numbers::sqrt2, row[2];
      tension *= 2;
    } else {
      const auto row = multipliers.segment<2>(2 * static_cast<Index>(e));
      const Svd32 parts = svd(triangle.deformation_gradient(corners(triangle, x).data()));
      tension =
          row[0] / parts.d1 * parts.v1 * parts.v1.transpose() + row[1] / parts.d2 * parts.v2 * parts.v2.transpose();
    }
    add(tensions, triangle.vertices, tension);
  }
}

double largest_eigenvalue(const Matrix2& m) { return eigen2(m(0, 0), (m(0, 1) + m(1, 0)) / 2, m(1, 1)).values[0]; }

}  // namespace

bool has_tension(const Model& model) {
  if (model.modal) return false;
  const bool membranes = std::any_of(model.elastic.begin(), model.elastic.end(), [](const auto& energy) {
    return dynamic_cast<const Membrane*>(energy.get()) != nullptr;
  });
  return membranes || !model.shells.empty();
}

double peak_tension(const Model& model, const State& state) {
  const Vector& x = state.positions;
  Tensions tensions;
  for (const auto& energy : model.elastic) {
    if (const auto* membrane = dynamic_cast<const Membrane*>(energy.get())) add_membrane(*membrane, x, tensions);
  }
  for (std::size_t k = 0; k < std::min(model.constraints.size(), state.warm.multipliers.size()); ++k) {
    const Constraint* constraint = model.constraints[k].get();
    if (const auto* matrix = dynamic_cast<const MatrixStrainLimit*>(constraint))
      add_limit(matrix->limit(), state.warm.multipliers[k], true, x, tensions);
    if (const auto* values = dynamic_cast<const SingularValueStrainLimit*>(constraint))
      add_limit(values->limit(), state.warm.multipliers[k], false, x, tensions);
  }
  double peak = 0;
  for (const auto& [unused, tension] : tensions) peak = std::max(peak, largest_eigenvalue(tension));
  for (const Model::Shell& shell : model.shells) {
    for (int t = 0; t < shell.section.triangles(); ++t) {
      const Vector3 n = shell.section.resultants(t, x).n;
      peak = std::max(peak, eigen2(n[0], n[2], n[1]).values[0]);
    }
  }
  return peak;
}

}  // namespace taut
