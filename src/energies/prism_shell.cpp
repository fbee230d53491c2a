#include "energies/prism_shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "energies/enhanced_thickness.h"
#include "energies/prism_assembly.h"
#include "energies/prism_quadrature.h"

namespace taut {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int thickness_axis = 2;  // E33 in Voigt's order

double shear_factor(const PrismShape& shape, const PrismShellOptions& options) {
  if (options.element == PrismElement::plain) return 1;
  double longest = 0;
  for (int j = 0; j < 3; ++j) longest = std::max(longest, (shape.mid.col(j) - shape.mid.col((j + 1) % 3)).norm());
  const double thickness = 2 * shape.director.colwise().norm().mean();
  const double soft = options.shear_stabilisation * longest * longest;
  return options.shear_correction * thickness * thickness / (thickness * thickness + soft);
}

/// The smallest s in (0, 2] where det(A + s B) <= 0, infinity where there is none; det A > 0.
double first_zero_determinant(const Matrix3& a, const Matrix3& b) {
  const auto mixed = [](const Matrix3& p, const Matrix3& q) {  // d det(p + s q)/ds at 0
    return q.col(0).dot(p.col(1).cross(p.col(2))) + q.col(1).dot(p.col(2).cross(p.col(0))) +
           q.col(2).dot(p.col(0).cross(p.col(1)));
  };
  const double c0 = a.determinant(), c1 = mixed(a, b), c2 = mixed(b, a), c3 = b.determinant();
  const auto value = [&](double s) { return c0 + s * (c1 + s * (c2 + s * c3)); };
  // Between 0, the extrema and 2 the cubic is monotone.
  double stops[3] = {2, 2, 2};
  const double discriminant = c2 * c2 - 3 * c1 * c3;
  if (discriminant >= 0) {
    const double q = -(c2 + std::copysign(std::sqrt(discriminant), c2));
    const double roots[2] = {q / (3 * c3), c1 / q};
    for (int i = 0; i < 2; ++i) {
      if (roots[i] > 0 && roots[i] < 2) stops[i] = roots[i];
    }
    if (stops[0] > stops[1]) std::swap(stops[0], stops[1]);
  }
  double low = 0;
  for (double stop : stops) {
    if (value(stop) > 0) {
      low = stop;
      continue;
    }
    double high = stop;
    for (int i = 0; i < 60; ++i) (value(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
    return low;
  }
  return infinity;
}

/// Adds a b^T, which is symmetric, to `total` on and below its diagonal, and in the diagonal's 4 x 4 blocks. Lazy
/// products: Eigen's blocked ones cost several times as much on matrices this small.
void add_lower_product(const StrainMatrix& a, const StrainMatrix& b, GramStiffness& total) {
  total.leftCols<4>() += a.lazyProduct(b.topRows<4>().transpose());
  total.block<12, 4>(4, 4) += a.bottomRows<12>().lazyProduct(b.middleRows<4>(4).transpose());
  total.block<8, 4>(8, 8) += a.bottomRows<8>().lazyProduct(b.middleRows<4>(8).transpose());
  total.bottomRightCorner<4, 4>() += a.bottomRows<4>().lazyProduct(b.bottomRows<4>().transpose());
}

/// Asks for numbers that will be read soon.
void prefetch(const double* first, std::size_t count) {
  for (std::size_t k = 0; k < count; k += 8) __builtin_prefetch(first + k);
}

void mirror_lower(GramStiffness& stiffness) {
  stiffness.triangularView<Eigen::StrictlyUpper>() = stiffness.transpose();
}

}  // namespace

void PrismShellOptions::validate() const {
  triangle_rule(points_in_plane);
  if (points_in_thickness < 2 || points_in_thickness > 4) {
    throw std::invalid_argument("PrismShellOptions: points_in_thickness must be 2, 3 or 4");
  }
  if (!(shear_correction > 0)) throw std::invalid_argument("PrismShellOptions: shear_correction must be positive");
  if (!(shear_stabilisation >= 0)) {
    throw std::invalid_argument("PrismShellOptions: shear_stabilisation must not be negative");
  }
}

std::vector<RestPrism> rest_prisms(const std::vector<Prism>& prisms, const std::vector<Vector3>& nodes,
                                   const Vector3& direction, int first_node) {
  std::vector<RestPrism> rest;
  for (const Prism& prism : prisms) {
    RestPrism& r = rest.emplace_back();
    r.direction = direction;
    for (int j = 0; j < 6; ++j) {
      r.nodes[j] = prism[j] + first_node;
      r.points[j] = nodes.at(prism[j]);
    }
  }
  return rest;
}

PrismShell::PrismShell(std::string name, const std::vector<RestPrism>& prisms, const SolidMaterial& material,
                       const PrismShellOptions& options)
    : name_(std::move(name)), material_(material), options_(options) {
  options_.validate();
  if (options_.element == PrismElement::plain) options_.enhanced_thickness = false;
  std::vector<Place> places;
  for (const TrianglePoint& in_plane : triangle_rule(options_.points_in_plane)) {
    for (const LinePoint& line : gauss_rule(options_.points_in_thickness))
      places.push_back(place_at(in_plane.l, line.gamma, in_plane.weight * line.weight));
  }
  std::vector<Point> points(places.size());
  kinematics_.reserve(prisms.size());
  rest_.reserve(prisms.size());
  scale_.reserve(prisms.size());
  if (material_.law == SolidLaw::stvk)
    stiffness_.reserve(prisms.size());
  else
    points_.reserve(prisms.size() * places.size());
  for (const RestPrism& prism : prisms) {
    const PrismShape shape(prism.points);
    if (!(PrismJacobian(shape).smallest() > 0)) {
      throw std::invalid_argument(name_ + ": expected prisms with a positive Jacobian, got an inverted one, number " +
                                  std::to_string(rest_.size()));
    }
    kinematics_.emplace_back(shape, prism.direction, options_.element, shear_factor(shape, options_));
    for (std::size_t q = 0; q < places.size(); ++q) points[q] = point_at(kinematics_.back(), places[q]);
    stencils_.add_vertices(prism.nodes);
    rest_.push_back(kinematics_.back().rest_gram());
    scale_.emplace_back(2 * rest_.back()[gram_pair(0, 0)], 2 * rest_.back()[gram_pair(1, 1)],
                        shape.director.squaredNorm() / 3);
    if (material_.law == SolidLaw::stvk) {
      stiffness_.push_back(packed(constant_stiffness(points.data())));
    } else {
      points_.insert(points_.end(), points.begin(), points.end());
    }
  }
}

PrismShell::Point PrismShell::point_at(const PrismKinematics& kinematics, const Place& place) const {
  const auto& [l, gamma, weight, covariant] = place;
  const double middle = kinematics.jacobian(l, 0).determinant(), here = kinematics.jacobian(l, gamma).determinant();
  // Weighted so that constant stresses do no work on it: the patch test (Simo and Rifai 1990).
  const double enhancement = options_.enhanced_thickness ? gamma * middle / here : 0.0;
  return {kinematics.strain(covariant, l, gamma), weight * here, enhancement};
}

std::vector<PrismShell::Point> PrismShell::column_at(const PrismKinematics& kinematics, const Vector3& l,
                                                     double weight) const {
  std::vector<Point> column;
  column.reserve(static_cast<std::size_t>(options_.points_in_thickness));
  for (const LinePoint& line : gauss_rule(options_.points_in_thickness)) {
    column.push_back(point_at(kinematics, place_at(l, line.gamma, weight * line.weight)));
  }
  return column;
}

double PrismShell::enhanced_strain(const Point* column, const Voigt* strains) const {
  const int count = options_.points_in_thickness;
  if (material_.law == SolidLaw::stvk) {
    double work = 0, stiffness = 0;
    for (int g = 0; g < count; ++g) {
      const double weight = column[g].volume * column[g].enhancement;
      work += weight * material_.elasticity.row(thickness_axis).dot(strains[g]);
      stiffness += weight * column[g].enhancement * material_.elasticity(thickness_axis, thickness_axis);
    }
    return -work / stiffness;
  }
  EnhancedColumn enhanced;
  enhanced.count = count;
  for (int g = 0; g < count; ++g) {
    const Voigt& e = strains[g];
    const double c11 = 1 + 2 * e[0], c22 = 1 + 2 * e[1], c33 = 1 + 2 * e[2];
    const double area = c11 * c22 - e[3] * e[3];
    enhanced.weight[g] = column[g].volume;
    enhanced.growth[g] = column[g].enhancement;
    enhanced.slope[g] = 2 * column[g].enhancement * area;
    enhanced.determinant[g] = c33 * area + 2 * e[3] * e[4] * e[5] - c11 * e[5] * e[5] - c22 * e[4] * e[4];
  }
  return enhanced.minimiser(material_.lambda, material_.mu);
}

PrismState PrismShell::state(Index element, const double* x, const Vector3& l, double gamma) const {
  const PrismKinematics& kinematics = kinematics_[element];
  const GramStrain gram_strain = gram(prism_vectors(x)) - rest_[element];
  const Point here = point_at(kinematics, place_at(l, gamma, 1.0));
  PrismState state{kinematics.frame(), here.strain.transpose() * gram_strain, Voigt::Zero()};
  if (options_.enhanced_thickness) {
    const std::vector<Point> column = column_at(kinematics, l, 1.0);
    std::vector<Voigt> strains;
    strains.reserve(column.size());
    for (const Point& point : column) strains.push_back(point.strain.transpose() * gram_strain);
    state.strain[thickness_axis] += here.enhancement * enhanced_strain(column.data(), strains.data());
  }
  if (material_.law == SolidLaw::stvk) {
    state.stress = material_.elasticity * state.strain;
  } else {
    const NeoHookeanPoint law(material_, state.strain);
    state.stress = law.valid ? law.stress : Voigt::Constant(std::nan(""));
  }
  // The strains carry the root of the shear factor; the stresses do work on those without it.
  state.stress.tail<2>() *= kinematics.shear_scale();
  return state;
}

GramStiffness PrismShell::constant_stiffness(const Point* points) const {
  GramStiffness total = GramStiffness::Zero();
  for (int column = 0; column < options_.points_in_plane; ++column) {
    GramStrain coupling = GramStrain::Zero();
    double enhanced = 0;
    for (int g = 0; g < options_.points_in_thickness; ++g, ++points) {
      const StrainMatrix stress = points->volume * points->strain.lazyProduct(material_.elasticity);
      add_lower_product(points->strain, stress, total);
      coupling += points->enhancement * stress.col(thickness_axis);
      enhanced += points->volume * points->enhancement * points->enhancement *
                  material_.elasticity(thickness_axis, thickness_axis);
    }
    if (enhanced > 0) total -= coupling.lazyProduct(coupling.transpose() / enhanced);
  }
  mirror_lower(total);
  return total;
}

PrismShell::PackedStiffness PrismShell::packed(const GramStiffness& stiffness) {
  PackedStiffness blocks;
  double* at = blocks.data();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j, at += 16) Eigen::Matrix4d::Map(at) = stiffness.block<4, 4>(4 * i, 4 * j);
  }
  return blocks;
}

GramStiffness PrismShell::unpacked(const PackedStiffness& stiffness) {
  GramStiffness full;
  const double* at = stiffness.data();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j, at += 16) {
      const Eigen::Map<const Eigen::Matrix4d> block(at);
      full.block<4, 4>(4 * i, 4 * j) = block;
      if (j < i) full.block<4, 4>(4 * j, 4 * i) = block.transpose();
    }
  }
  return full;
}

GramStrain PrismShell::product(const PackedStiffness& stiffness, const GramStrain& strain) {
  GramStrain force = GramStrain::Zero();
  const double* at = stiffness.data();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j, at += 16) {
      const Eigen::Map<const Eigen::Matrix4d> block(at);
      force.segment<4>(4 * i) += block.lazyProduct(strain.segment<4>(4 * j));
      if (j < i) force.segment<4>(4 * j) += block.transpose().lazyProduct(strain.segment<4>(4 * i));
    }
  }
  return force;
}

bool PrismShell::add_neo_hookean_column(const Point* column, const GramStrain& strain, Wanted wanted,
                                        Curvature curvature, Response& response) const {
  const int count = options_.points_in_thickness;
  std::array<Voigt, most_in_thickness> local;
  local.fill(Voigt::Zero());
  for (int g = 0; g < count; ++g) local[g] = column[g].strain.transpose() * strain;
  if (options_.enhanced_thickness) {
    const double alpha = enhanced_strain(column, local.data());
    for (int g = 0; g < count; ++g) local[g][thickness_axis] += alpha * column[g].enhancement;
  }
  GramStrain coupling = GramStrain::Zero();
  double stiffness = 0;
  for (int g = 0; g < count; ++g) {
    const Point& point = column[g];
    const NeoHookeanPoint law(material_, local[g]);
    if (!law.valid) return false;
    response.value += point.volume * law.density;
    if (wanted == Wanted::value) continue;
    response.force.noalias() += point.strain * (point.volume * law.stress);
    if (wanted == Wanted::force) continue;
    const Elasticity tangent = point.volume * law.tangent(curvature == Curvature::positive_semidefinite);
    const StrainMatrix stress = point.strain.lazyProduct(tangent);
    add_lower_product(point.strain, stress, response.stiffness);
    coupling += point.enhancement * stress.col(thickness_axis);
    stiffness += point.enhancement * point.enhancement * tangent(thickness_axis, thickness_axis);
  }
  if (stiffness > 0) response.stiffness -= coupling * coupling.transpose() / stiffness;
  return true;
}

double PrismShell::evaluate(Index element, const double* x, double* gradient, double* hessian,
                            Curvature curvature) const {
  const PrismVectors v = prism_vectors(x);
  const GramStrain strain = gram(v) - rest_[element];
  if (material_.law == SolidLaw::stvk) {
    // Elements are mostly visited in order, and wait for memory.
    const std::size_t soon = static_cast<std::size_t>(element) + 2;
    if (soon < stiffness_.size()) prefetch(stiffness_[soon].data(), stiffness_[soon].size());
    const GramStrain force = product(stiffness_[element], strain);
    if (gradient) prism_gradient(v, force, gradient);
    if (hessian) prism_hessian(v, force, unpacked(stiffness_[element]), scale_[element], curvature, hessian);
    return 0.5 * strain.dot(force);
  }
  Response response;
  const Wanted wanted = hessian ? Wanted::stiffness : gradient ? Wanted::force : Wanted::value;
  const Point* column = points_.data() + element * options_.points_in_plane * options_.points_in_thickness;
  for (int q = 0; q < options_.points_in_plane; ++q, column += options_.points_in_thickness) {
    if (add_neo_hookean_column(column, strain, wanted, curvature, response)) continue;
    if (gradient) std::fill_n(gradient, 18, 0.0);
    if (hessian) std::fill_n(hessian, 18 * 18, 0.0);
    return infinity;
  }
  if (gradient) prism_gradient(v, response.force, gradient);
  if (hessian) mirror_lower(response.stiffness);
  if (hessian) prism_hessian(v, response.force, response.stiffness, scale_[element], curvature, hessian);
  return response.value;
}

double PrismShell::largest_step(Index /*element*/, const double* x, const double* dx) const {
  const PrismVectors v = prism_vectors(x), dv = prism_vectors(dx);
  double largest = infinity;
  for (const TrianglePoint& in_plane : triangle_rule(options_.points_in_plane)) {
    for (const LinePoint& line : gauss_rule(options_.points_in_thickness)) {
      const TangentCoefficients g = tangents(in_plane.l, line.gamma);
      largest = std::min(largest, first_zero_determinant(v * g, dv * g));
    }
  }
  return largest;
}

}  // namespace taut
