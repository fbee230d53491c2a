#include "dynamics/modal/modal_basis.h"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "dynamics/modal/natural_modes.h"
#include "dynamics/modal/warping.h"

namespace taut {
namespace {

constexpr int rigid_motions = 6;

Vector mass_times(const Model& model, const Vector& v) {
  Vector out = Vector::Zero(v.size());
  for (const auto& inertia : model.inertia) inertia->add_product(v, out);
  return out;
}

/// The elastic energies about the start.
struct ElasticState {
  Vector force, diagonal;        // gradient, zero at pins, and the diagonal of the Hessian
  double largest_force = 0;      // of a single element
  double largest_stiffness = 0;  // diagonal entry of a single element
};

ElasticState elastic_state(const Model& model) {
  const Index size = model.positions.size();
  ElasticState sum{Vector::Zero(size), Vector::Zero(size)};
  for (const auto& energy : model.elastic) {
    const Stencils& stencils = energy->stencils();
    Vector local(stencils.width()), gradient(stencils.width());
    Matrix hessian(stencils.width(), stencils.width());
    for (Index element = 0; element < stencils.count(); ++element) {
      stencils.gather(element, model.positions, local.data());
      energy->evaluate(element, local.data(), gradient.data(), hessian.data(), Curvature::exact);
      for (int i = 0; i < stencils.width(); ++i) {
        sum.force[stencils[element][i]] += gradient[i];
        sum.diagonal[stencils[element][i]] += hessian(i, i);
      }
      sum.largest_force = std::max(sum.largest_force, gradient.lpNorm<Eigen::Infinity>());
      sum.largest_stiffness = std::max(sum.largest_stiffness, hessian.diagonal().lpNorm<Eigen::Infinity>());
    }
  }
  for (const PinnedVariable& pin : model.pins) sum.force[pin.variable] = 0;
  return sum;
}

/// Throws unless the elastic forces are small beside that of a single element, or beside what a displacement by 1e-4 of
/// the body's size would cost.
void expect_equilibrium(const Model& model, const ElasticState& elastic) {
  const double extent = model.positions.maxCoeff() - model.positions.minCoeff();
  const double scale = std::max(elastic.largest_force, 1e-4 * extent * elastic.largest_stiffness);
  const double force = elastic.force.lpNorm<Eigen::Infinity>();
  if (force <= 1e-8 * scale) return;
  throw std::invalid_argument("the start is no equilibrium: an elastic force of " + std::to_string(force) +
                              " N is not balanced");
}

/// Makes the columns M-orthonormal, in order.
void orthonormalise(const Model& model, Matrix& columns) {
  for (Index k = 0; k < columns.cols(); ++k) {
    for (int pass = 0; pass < 2; ++pass) {
      const Vector inertia = mass_times(model, columns.col(k));
      const Vector parts = columns.leftCols(k).transpose() * inertia;
      columns.col(k) -= columns.leftCols(k) * parts;
    }
    columns.col(k) /= std::sqrt(columns.col(k).dot(mass_times(model, columns.col(k))));
  }
}

/// Translations, then rotations about the centre of mass, M-orthonormal.
Matrix rigid_modes(const Model& model) {
  const Index nodes = model.positions.size() / 3;
  Matrix motions = Matrix::Zero(3 * nodes, rigid_motions);
  for (Index node = 0; node < nodes; ++node) motions.block<3, 3>(3 * node, 0).setIdentity();
  const Vector along = mass_times(model, motions.col(0));
  Vector3 centre = Vector3::Zero();
  double mass = 0;
  for (Index node = 0; node < nodes; ++node) {
    mass += along[3 * node];
    centre += along[3 * node] * model.positions.segment<3>(3 * node);
  }
  centre /= mass;
  for (Index node = 0; node < nodes; ++node) {
    const Vector3 arm = model.positions.segment<3>(3 * node) - centre;
    for (int axis = 0; axis < 3; ++axis) motions.block<3, 1>(3 * node, 3 + axis) = Vector3::Unit(axis).cross(arm);
  }
  orthonormalise(model, motions);
  return motions;
}

void add_block(std::vector<Eigen::Triplet<double>>& entries, int row, int column, const Matrix3& block) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) entries.emplace_back(3 * row + i, 3 * column + j, block(i, j));
  }
}

Matrix3 cross(const Vector3& w) {
  Matrix3 m;
  m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return m;
}

/// The operator from its weighted entries: rows are divided by their node's weight.
SparseMatrix averaged(const std::vector<Eigen::Triplet<double>>& entries, const Vector& weights) {
  SparseMatrix curl(3 * weights.size(), 3 * weights.size());
  curl.setFromTriplets(entries.begin(), entries.end());
  Vector factors(3 * weights.size());
  for (Index node = 0; node < weights.size(); ++node) {
    factors.segment<3>(3 * node).setConstant(weights[node] > 0 ? 1 / weights[node] : 0);
  }
  return factors.asDiagonal() * curl;
}

}  // namespace

Vector ModalBasis::positions(const Vector& q) const {
  const Vector d = shapes * q;
  if (!warped) return rest + d;
  const Vector w = rotations * q;
  Vector x = rest;
  for (Index i = 0; i < rest.size(); i += 3) {
    x.segment<3>(i) += warp_integral(w.segment<3>(i)) * d.segment<3>(i);
  }
  return x;
}

Vector ModalBasis::velocities(const Vector& q, const Vector& v) const {
  const Vector d = shapes * q, moved = shapes * v;
  if (!warped) return moved;
  const Vector w = rotations * q, turned = rotations * v;
  Vector rates(rest.size());
  for (Index i = 0; i < rest.size(); i += 3) {
    rates.segment<3>(i) = warp_integral(w.segment<3>(i)) * moved.segment<3>(i) +
                          warp_derivative(d.segment<3>(i), w.segment<3>(i)) * turned.segment<3>(i);
  }
  return rates;
}

Matrix ModalBasis::jacobian(Index node, const Vector& q) const {
  const auto phi = shapes.middleRows<3>(3 * node);
  if (!warped) return phi;
  const auto psi = rotations.middleRows<3>(3 * node);
  const Vector3 d = phi * q, w = psi * q;
  return warp_integral(w) * phi + warp_derivative(d, w) * psi;
}

namespace {

Matrix full_jacobian(const ModalBasis& basis, const Vector& q) {
  Matrix jacobian(basis.rest.size(), basis.modes());
  for (Index node = 0; node < basis.nodes(); ++node) jacobian.middleRows<3>(3 * node) = basis.jacobian(node, q);
  return jacobian;
}

}  // namespace

Vector ModalBasis::coordinates(const Vector& x, Vector guess) const {
  for (int step = 0; step < 30; ++step) {
    const Matrix jacobian = full_jacobian(*this, guess);
    const Vector change = jacobian.colPivHouseholderQr().solve(x - positions(guess));
    guess += change;
    if (change.norm() <= 1e-14 * (1 + guess.norm())) break;
  }
  return guess;
}

Vector ModalBasis::rates(const Vector& q, const Vector& rates) const {
  return full_jacobian(*this, q).colPivHouseholderQr().solve(rates);
}

ModalBasis ModalBasis::truncated(Index modes) const {
  ModalBasis fewer = *this;
  fewer.shapes.conservativeResize(Eigen::NoChange, modes);
  fewer.rotations.conservativeResize(Eigen::NoChange, modes);
  fewer.eigenvalues.conservativeResize(modes);
  fewer.residuals.conservativeResize(modes);
  fewer.rigid = std::min(rigid, static_cast<int>(modes));
  return fewer;
}

SparseMatrix surface_curl(const std::vector<Vector3>& points, const std::vector<Triangle>& triangles) {
  std::vector<Eigen::Triplet<double>> entries;
  Vector weights = Vector::Zero(static_cast<Index>(points.size()));
  for (const Triangle& t : triangles) {
    const Vector3 area = (points[t[1]] - points[t[0]]).cross(points[t[2]] - points[t[0]]);
    const Vector3 n = area.normalized();
    for (int j = 0; j < 3; ++j) {
      // The gradient of corner j's hat function, times twice the area.
      const Vector3 g = n.cross(points[t[(j + 2) % 3]] - points[t[(j + 1) % 3]]);
      const Matrix3 block = g.cross(n) * n.transpose() + 0.5 * n * n.cross(g).transpose();
      for (const int at : t) add_block(entries, at, t[j], block);
      weights[t[j]] += area.norm();
    }
  }
  return averaged(entries, weights);
}

SparseMatrix prism_curl(const std::vector<Vector3>& points, const std::vector<std::array<int, 6>>& prisms) {
  std::vector<Eigen::Triplet<double>> entries;
  Vector weights = Vector::Zero(static_cast<Index>(points.size()));
  for (const auto& prism : prisms) {
    const auto point = [&](int vertex, int level) -> const Vector3& { return points[prism[2 * vertex + level]]; };
    for (int vertex = 0; vertex < 3; ++vertex) {
      for (int level = 0; level < 2; ++level) {
        // X = sum_k L_k ((1 - s) bottom_k + s top_k), in the coordinates L_1, L_2 and s.
        Matrix3 map;
        map << point(1, level) - point(0, level), point(2, level) - point(0, level),
            point(vertex, 1) - point(vertex, 0);
        const Matrix3 inverse = map.inverse();
        const double weight = map.determinant();
        const std::array<Vector3, 3> hats{-inverse.row(0) - inverse.row(1), inverse.row(0), inverse.row(1)};
        const int at = prism[2 * vertex + level];
        for (int j = 0; j < 3; ++j) add_block(entries, at, prism[2 * j + level], 0.5 * weight * cross(hats[j]));
        for (const int side : {0, 1}) {
          const Vector3 g = (side == 1 ? 1.0 : -1.0) * inverse.row(2).transpose();
          add_block(entries, at, prism[2 * vertex + side], 0.5 * weight * cross(g));
        }
        weights[at] += weight;
      }
    }
  }
  return averaged(entries, weights);
}

SparseMatrix tetrahedron_curl(const std::vector<Vector3>& points, const std::vector<std::array<int, 4>>& cells) {
  std::vector<Eigen::Triplet<double>> entries;
  Vector weights = Vector::Zero(static_cast<Index>(points.size()));
  for (const auto& cell : cells) {
    Matrix3 edges;
    for (int j = 0; j < 3; ++j) edges.col(j) = points[cell[j + 1]] - points[cell[0]];
    const Matrix3 inverse = edges.inverse();
    const double volume = edges.determinant() / 6;
    for (int j = 0; j < 4; ++j) {
      const Vector3 g = j == 0 ? Vector3(-inverse.colwise().sum()) : Vector3(inverse.row(j - 1));
      for (const int at : cell) add_block(entries, at, cell[j], 0.5 * volume * cross(g));
      weights[cell[j]] += volume;
    }
  }
  return averaged(entries, weights);
}

ModalBasis modal_basis(const Model& model, const SparseMatrix& curl, int count, int threads) {
  const ElasticState elastic = elastic_state(model);
  expect_equilibrium(model, elastic);
  std::vector<const Energy*> energies;
  for (const auto& energy : model.elastic) energies.push_back(energy.get());
  const std::vector<NaturalMode> modes = natural_modes(model, energies, model.positions, count, threads);

  ModalBasis basis;
  basis.rest = model.positions;
  basis.shapes.resize(model.positions.size(), count);
  basis.eigenvalues.resize(count);
  basis.residuals.resize(count);
  for (int k = 0; k < count; ++k) {
    const double rate = 2 * std::numbers::pi * modes[k].frequency;
    basis.shapes.col(k) = modes[k].shape;
    basis.eigenvalues[k] = std::copysign(rate * rate, rate);
    basis.residuals[k] = modes[k].residual;
  }
  if (model.pins.empty()) {
    basis.rigid = std::min(rigid_motions, count);
    basis.shapes.leftCols(basis.rigid) = rigid_modes(model).leftCols(basis.rigid);
    orthonormalise(model, basis.shapes);
    basis.eigenvalues.head(basis.rigid).setZero();
  }
  // What costs no energy has only round-off for a value, beside those that do: the largest of the whole spectrum is
  // about the largest K_ii over M_ii.
  const Vector mass = mass_times(model, Vector::Ones(elastic.diagonal.size()));
  const double largest = elastic.diagonal.cwiseQuotient(mass).cwiseAbs().maxCoeff();
  const double least = std::max(1e-9 * basis.eigenvalues.cwiseAbs().maxCoeff(), 1e-14 * largest);
  for (int k = basis.rigid; k < count; ++k) {
    if (basis.eigenvalues[k] > least) continue;
    throw std::invalid_argument("mode " + std::to_string(k + 1) + " costs no energy (value " +
                                std::to_string(basis.eigenvalues[k]) +
                                " 1/s^2): a membrane needs bending or tension, and a clamp that leaves no hinge");
  }
  basis.rotations = curl * basis.shapes;
  return basis;
}

}  // namespace taut
