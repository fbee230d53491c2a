#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/residuals.h"
#include "core/types.h"
#include "energies/membrane.h"
#include "energies/prism_shell.h"
#include "geometry/grid.h"
#include "solvers/augmented_lagrangian.h"
#include "solvers/nlopt.h"

namespace taut {

/// A problem file that cannot be used, in one line: "FILE: /json/pointer: found WHAT, allowed: WHAT".
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  InputError(const std::string& source, const std::string& pointer, std::string_view text)
      : std::runtime_error(source + ": " + (pointer.empty() ? "/" : pointer) + ": " + std::string(text)) {}
};

/// The parts of a Scene. They mirror the keys of problem.schema.json, which explains each; here are units and what
/// reading adds. Angles are radians, directions have length 1, paths are resolved against the problem file.
namespace scene {

enum class Integrator { implicit_euler, bdf2, generalised_alpha, newmark, quasi_static };
struct Time {
  Integrator integrator = Integrator::implicit_euler;
  double step = 0;  ///< s; 1 / steps for quasi_static, so that time k * step always holds
  int steps = 1;
  double spectral_radius = 0.8;
  double beta = 0.3025, gamma = 0.6;  ///< of newmark
  int halvings = 0;                   ///< of a static load step that is not solved
  int frequencies = 0;                ///< how many natural frequencies are computed at the end of a static problem
};

struct Grid {
  Vector2 size{1, 1};  ///< m
  int cells_x = 1, cells_y = 1;
  Diagonals diagonals = Diagonals::alternating;
};
struct MeshFile {
  std::filesystem::path path;
};
/// Of a cover: its shell's mesh, every triangle divided into four this often.
struct Refinement {
  int levels = 1;
};
struct Transform {
  double scale = 1;
  Vector3 axis = Vector3::UnitZ();
  double angle = 0;                     ///< rad
  Vector3 translate = Vector3::Zero();  ///< m

  Vector3 operator()(const Vector3& x) const;
};
enum class RestShape { initial, uv, mesh };
struct Rest {
  RestShape from = RestShape::initial;
  std::filesystem::path file;  ///< for RestShape::mesh
  double scale = 1;
};
enum class Mass { lumped, consistent };
struct Membrane {
  MembraneLaw law = MembraneLaw::stvk;
  double young_modulus = 0;  ///< Pa
  double poisson_ratio = 0;
};
struct Bending {
  double stiffness = 0;  ///< N m
};
struct Layer {
  double thickness = 0;  ///< m; of all its prisms
  double density = 0;    ///< kg/m3
  SolidMaterial material;
  double fibre_angle = 0;  ///< rad, from ThickShell::direction
  bool has_fibres = false;
  int prisms = 1;
};
/// A body of prisms between two surfaces.
struct ThickShell {
  std::filesystem::path top;  ///< the top surface, the mesh is the bottom then; empty: the mesh is in the middle
  std::vector<Layer> layers;  ///< from the bottom, at least one; without a thickness where `top` or the next two say it
  std::vector<double> vertex_thickness;  ///< m, one a vertex, all layers together; not yet compared with the mesh
  std::string thickness_property;        ///< of the vertices of the mesh file, in place of it
  PrismShellOptions options;
  Vector3 direction = Vector3::UnitX();  ///< where fibre angles count from
};
/// Tetrahedra of a Gmsh file, linearly elastic about rest: for the modes of a modal body.
struct Solid {
  double young_modulus = 0;  ///< Pa
  double poisson_ratio = 0;
};
/// Nodes of a thick shell at a mesh vertex; of cloth the only one, whatever is asked for.
enum class Surface { both, bottom, top, mid };
/// What makes a body the fine membrane of the shell before it in the list.
struct Cover {
  Surface surface = Surface::top;
  double foundation = 0;             ///< Pa/m; 0: none
  double amplitude = 0;              ///< of the imperfection, m
  unsigned seed = 1;                 ///< of the imperfection
  std::optional<double> farthest{};  ///< m
};
struct Damping {
  double mass = 0;       ///< 1/s
  double stiffness = 0;  ///< s
};
struct ByIndex {
  std::vector<int> vertices;  ///< not yet compared with the mesh
};
struct AtCorners {
  std::vector<std::string> names;  ///< as select_corner() takes them
};
struct OnEdges {
  std::vector<std::string> names;  ///< as select_edge() takes them
};
struct InBox {
  Vector3 min, max;  ///< m
};
struct InBall {
  Vector3 center;  ///< m
  double radius;   ///< m
};
struct NearestTo {
  std::vector<Vector3> points;  ///< m
};
struct InGroup {
  std::string name;  ///< not yet compared with the mesh
};
struct OnBoundary {};
struct Everything {};
/// Vertices of one body, at their transformed initial positions. Corners and edges occur on grids only.
using Selection = std::variant<Everything, ByIndex, AtCorners, OnEdges, InBox, InBall, NearestTo, InGroup, OnBoundary>;

enum class WarpRotation { exact, predictor, none };
/// What makes a body move in a few of its modes.
struct Modal {
  int modes = 20;
  std::optional<Selection> clamp;  ///< held by the modes themselves; none: the body floats
  double damping_ratio = 0;        ///< of every mode, of critical
  WarpRotation rotation = WarpRotation::exact;
  std::filesystem::path basis;  ///< modes computed before; empty: none
};
struct Body {
  std::string name;
  std::variant<Grid, MeshFile, Refinement> mesh;
  Transform transform;
  Rest rest;
  double thickness = 0;  ///< m
  double density = 0;    ///< kg/m3
  Mass mass = Mass::lumped;
  std::optional<Membrane> membrane;
  std::optional<Bending> bending;
  std::optional<ThickShell> shell;  ///< without it the body is cloth
  std::optional<Cover> cover;
  std::optional<Solid> solid;
  std::optional<Modal> modal;                  ///< the body moves in modes of what the other members say
  Damping damping;                             ///< zero: none
  Vector3 initial_velocity = Vector3::Zero();  ///< m/s
};

struct Keyframe {
  double time = 0;                        ///< s
  Vector3 translation = Vector3::Zero();  ///< m
  double angle = 0;                       ///< rad
};
/// x(t) = point + R(axis, angle(t)) (x - point) + translation(t), with angle(t) = keyframes + t angular_velocity and
/// translation(t) = keyframes + t velocity.
struct Motion {
  std::vector<Keyframe> keyframes;  ///< strictly ascending in time; linear between, constant outside
  Vector3 axis = Vector3::UnitZ();
  Vector3 point = Vector3::Zero();     ///< m
  Vector3 velocity = Vector3::Zero();  ///< m/s
  double angular_velocity = 0;         ///< rad/s

  /// True where nothing ever moves.
  bool at_rest() const;
  /// Where the point that is at x at time 0 would be at `time` (s).
  Vector3 position(const Vector3& x, double time) const;
  /// The direction that is d at time 0, at `time` (s).
  Vector3 direction(const Vector3& d, double time) const;
};

struct Pin {
  bool x = true, y = true, z = true;  ///< which coordinates are held
  Motion motion;
};
enum class LimitForm { matrix, singular_values };
struct StrainLimit {
  LimitForm form = LimitForm::matrix;
  std::optional<double> min, max;  ///< singular values; at least one, min <= max
};
struct HalfSpace {
  Vector3 point, normal;  ///< m; towards the allowed side
  Motion motion;
};
struct Sphere {
  Vector3 center;  ///< m
  double radius;   ///< m
  Motion motion;
};
struct Constraint {
  std::string name;
  int body = 0;  ///< index into Scene::bodies
  Selection select;
  Surface surface = Surface::both;
  std::variant<Pin, StrainLimit, HalfSpace, Sphere> kind;
};

struct PointLoad {
  Selection select;
  Vector3 force;  ///< N at each vertex
};
struct EdgeLoad {
  Selection select;
  Vector3 force_per_length;  ///< N/m
};
struct Pressure {
  double pressure;      ///< Pa
  bool follows = true;  ///< false: along the normals at rest, on the areas at rest
};
struct SurfaceLoad {
  Vector3 force_per_area;           ///< N/m2
  std::vector<Vector3> half_waves;  ///< 1/m
};
struct EndMoment {
  Selection select;
  Vector3 moment_per_length;  ///< N
};
struct Wind {
  Vector3 velocity;    ///< m/s
  double air_density;  ///< kg/m3
  double drag;
};
struct Load {
  std::string name;
  int body = 0;  ///< index into Scene::bodies
  Surface surface = Surface::both;
  std::variant<PointLoad, EdgeLoad, Pressure, SurfaceLoad, EndMoment, Wind> kind;
};

enum class OnFailure { stop, proceed };
enum class SolverMethod { augmented_lagrangian, null_space, alternating, ipopt, nlopt };
struct IpoptSettings {
  int max_iterations = 500;
  bool warm_start = false;
};
struct NloptSettings {
  NloptAlgorithm algorithm = NloptAlgorithm::slsqp;
  int max_evaluations = 20000;
};
struct Solver {
  SolverMethod method = SolverMethod::augmented_lagrangian;
  Tolerances tolerance;
  bool central_path = true;
  double penalty = 1000;  ///< factor on the automatic first penalty
  double penalty_growth = 8;
  double fixed_penalty = 0;  ///< 0: none
  bool penalised_pins = false;
  bool warm_multipliers = true;
  int max_outer = 100;
  int max_newton = 1000;  ///< per step
  double inner_tolerance_factor = 0.5;
  double longest_step = 0;  ///< 0: no limit
  double screening = 4;     ///< 0: none
  int starts = 1;           ///< of a model
  bool conjugate_gradients = false;
  bool newton_finish = false;
  EqualityForm equalities = EqualityForm::quasi_definite;
  IpoptSettings ipopt;
  NloptSettings nlopt;
  OnFailure on_failure = OnFailure::stop;
};

enum class FrameFormat { vtu, obj, none };
enum class Quantity {
  position,
  displacement,
  displacement_length,
  force,
  energy,
  resultant,
  stress,
  stretch,
  frequency
};
struct Expected {
  double value = 0, tolerance = 0;
  bool relative = false;  ///< tolerance times the value
  std::string source;
};
struct Probe {
  std::string name;
  Quantity quantity = Quantity::position;
  int axis = 0;   ///< or component: of (N11, N22, N12, M11, M22, M12, Q1, Q2), of a stress in Voigt's order, a stretch
  int layer = 0;  ///< of a stress or a stretch
  int mode = 1;   ///< of a frequency
  int body = 0;   ///< index into Scene::bodies
  Selection select;  ///< Everything for energies
  Surface surface = Surface::both;
  double factor = 1;
  std::optional<Expected> expected;
};
struct Output {
  FrameFormat format = FrameFormat::vtu;
  int every = 1;
  bool stresses = false;  ///< of thick shells, in frames
  int pictures = 3;
  std::optional<Vector3> view;
  std::vector<Probe> probes;
};

}  // namespace scene

/// A problem file, read, completed with defaults and checked; meshes are not read yet. Named parts are in order of
/// name, so that the order of keys in a file changes no bit of a result.
struct Scene {
  std::string name, description, look_for;
  std::string source;  ///< how errors call the file; InputError(scene.source, "/constraints/limit/select", ...) fits
  scene::Time time;
  Vector3 gravity = Vector3::Zero();  ///< m/s2
  std::vector<scene::Body> bodies;
  std::vector<scene::Constraint> constraints;
  std::vector<scene::Load> loads;
  scene::Solver solver;
  scene::Output output;
  /// The completed document as JSON text: keys sorted, overrides applied, mesh paths absolute. It reads as a problem
  /// file from anywhere.
  std::string document;
  std::string hash;  ///< 16 hex digits, see read_scene.h
};

}  // namespace taut
