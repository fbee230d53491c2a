#include "study/probes.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dynamics/modal/warped_position.h"

namespace taut {
namespace {

using scene::Quantity;

/// The gradient of the sum of energies, N.
Vector gradient_of(const Problem& problem, const Vector& x) {
  std::array<double, max_stencil_width> local, gradient;
  Vector sum = Vector::Zero(x.size());
  for (const Energy* energy : problem.energies) {
    const Stencils& stencils = energy->stencils();
    for (Index element = 0; element < stencils.count(); ++element) {
      stencils.gather(element, x, local.data());
      energy->evaluate(element, local.data(), gradient.data(), nullptr, Curvature::exact);
      for (int i = 0; i < stencils.width(); ++i) sum[stencils[element][i]] += gradient[i];
    }
  }
  return sum;
}

/// The forces of the holders on the vertices of a modal body: what balances the gradient of the energies, N.
Vector holding_forces(const Problem& problem, const Model& model, const Vector& x) {
  const Vector gradient = gradient_of(problem, x);
  std::vector<WarpedPosition::Held> held;
  Matrix rows(0, x.size());
  for (const auto& constraint : model.constraints) {
    const auto* positions = dynamic_cast<const WarpedPosition*>(constraint.get());
    if (!positions) continue;
    for (Index k = 0; k < positions->stencils().count(); ++k) {
      double value = 0;
      Vector row(x.size());
      positions->evaluate(k, x.data(), &value, row.data());
      rows.conservativeResize(rows.rows() + 1, Eigen::NoChange);
      rows.bottomRows(1) = row.transpose();
      held.push_back(positions->held()[static_cast<std::size_t>(k)]);
    }
  }
  Vector forces = Vector::Zero(model.modal->rest.size());
  if (held.empty()) return forces;
  const Vector along = rows.transpose().colPivHouseholderQr().solve(gradient);
  for (std::size_t k = 0; k < held.size(); ++k) forces[3 * held[k].node + held[k].axis] += along[static_cast<Index>(k)];
  return forces;
}

/// The elastic energy whose elements are in a body, J.
double elastic_energy(const Model& model, const BodyRange& body, const Vector& x) {
  std::array<double, max_stencil_width> local;
  double sum = 0;
  for (const auto& energy : model.elastic) {
    const Stencils& stencils = energy->stencils();
    for (Index element = 0; element < stencils.count(); ++element) {
      const int vertex = model.modal ? body.first_vertex : stencils[element][0] / 3;
      if (vertex < body.first_vertex || vertex >= body.first_vertex + body.vertices) continue;
      stencils.gather(element, x, local.data());
      sum += energy->evaluate(element, local.data(), nullptr, nullptr, Curvature::exact);
    }
  }
  return sum;
}

/// The sum of the vectors at the nodes.
Vector3 sum_over(const std::vector<int>& nodes, const Vector& values) {
  Vector3 sum = Vector3::Zero();
  for (const int node : nodes) sum += values.segment<3>(3 * node);
  return sum;
}

/// What a probe asks of the middle of a triangle.
double shell_value(const ShellSection& section, const scene::Probe& probe, int triangle, const Vector& x) {
  if (probe.quantity == Quantity::resultant) {
    const Resultants r = section.resultants(triangle, x);
    return probe.axis < 3 ? r.n[probe.axis] : probe.axis < 6 ? r.m[probe.axis - 3] : r.q[probe.axis - 6];
  }
  const double gamma = probe.surface == scene::Surface::bottom ? -1 : probe.surface == scene::Surface::mid ? 0 : 1;
  const LayerState state = section.state(triangle, probe.layer, gamma, x);
  return probe.quantity == Quantity::stress ? state.stress[probe.axis] : state.stretches[probe.axis];
}

/// Its mean over triangles, weighted by area.
double mean_shell_value(const Model& model, const scene::Probe& probe, const std::vector<int>& triangles,
                        const Vector& x) {
  const auto shell = std::find_if(model.shells.begin(), model.shells.end(),
                                  [&](const Model::Shell& s) { return s.body == probe.body; });
  double sum = 0, area = 0;
  for (const int triangle : triangles) {
    sum += shell->section.area(triangle) * shell_value(shell->section, probe, triangle, x);
    area += shell->section.area(triangle);
  }
  return sum / area;
}

}  // namespace

double ProbeValue::allowed() const {
  if (!expected) return std::numeric_limits<double>::infinity();
  return expected->relative ? expected->tolerance * std::abs(expected->value) : expected->tolerance;
}

bool ProbeValue::within() const { return !expected || std::abs(value - expected->value) <= allowed(); }

std::vector<ProbeValue> probes_of(const Scene& scene) {
  std::vector<ProbeValue> probes;
  for (const scene::Probe& probe : scene.output.probes)
    probes.push_back({probe.name, std::numeric_limits<double>::quiet_NaN(), probe.expected});
  return probes;
}

std::vector<NaturalMode> modes_at(const Scene& scene, const Model& model, const Problem& problem, const Vector& x,
                                  int step, int threads) {
  if (scene.time.frequencies == 0 || step < scene.time.steps) return {};
  return natural_modes(model, problem.energies, x, scene.time.frequencies, threads);
}

std::vector<double> probe_values(const Scene& scene, const Model& model, const Problem& problem, const Vector& x,
                                 const std::vector<NaturalMode>& modes) {
  std::vector<double> values;
  std::optional<Vector> gradient;
  const Vector vertices = model.vertex_positions(x);
  for (std::size_t k = 0; k < scene.output.probes.size(); ++k) {
    const scene::Probe& probe = scene.output.probes[k];
    const std::vector<int>& nodes = model.probed[k];
    const auto mean_displacement = [&] {
      return Vector3(sum_over(nodes, vertices - model.start()) / static_cast<double>(nodes.size()));
    };
    double value = 0;
    switch (probe.quantity) {
      case Quantity::position:
        value = sum_over(nodes, vertices)[probe.axis] / static_cast<double>(nodes.size());
        break;
      case Quantity::displacement:
        value = mean_displacement()[probe.axis];
        break;
      case Quantity::displacement_length:
        value = mean_displacement().norm();
        break;
      case Quantity::force:
        if (!gradient) gradient = model.modal ? holding_forces(problem, model, x) : gradient_of(problem, x);
        value = sum_over(nodes, *gradient)[probe.axis];
        break;
      case Quantity::energy:
        value = elastic_energy(model, model.bodies[static_cast<std::size_t>(probe.body)], x);
        break;
      case Quantity::resultant:
      case Quantity::stress:
      case Quantity::stretch:
        value = mean_shell_value(model, probe, nodes, vertices);
        break;
      case Quantity::frequency:
        value = probe.mode <= static_cast<int>(modes.size()) ? modes[static_cast<std::size_t>(probe.mode) - 1].frequency
                                                             : std::numeric_limits<double>::quiet_NaN();
        break;
    }
    values.push_back(probe.factor * value);
  }
  return values;
}

}  // namespace taut
