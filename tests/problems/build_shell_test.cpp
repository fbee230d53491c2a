#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "constraints/strain_limit.h"
#include "energies/prism_shell.h"
#include "problems/build.h"
#include "problems/read_scene.h"
#include "tests/files/temporary_folder.h"

namespace taut {
namespace {

using testing::ElementsAre;

const std::string grid = R"("mesh": {"grid": {"size": [2, 1], "cells": [2, 1]}})";
const std::string solid = R"("material": {"law": "stvk", "young_modulus": 1000, "poisson_ratio": 0.3})";
const std::string single = grid + R"(, "thickness": 0.1, "density": 50, )" + solid;
const std::string ply =
    R"({"E_L": 25, "E_T": 1, "G_LT": 0.5, "G_TT": 0.2, "nu_LT": 0.25, "nu_TT": 0.25, "fibre_degrees": 90})";

/// A static scene with one shell "s" over [0, 2] x [0, 1].
class BuildShell : public FilesTest {
 protected:
  Scene scene(const std::string& body = single, const std::string& sections = "") const {
    std::ofstream(path("p.json")) << R"({"format": 1, "time": {"integrator": "static", "steps": 1}, "bodies": {"s": {
      "model": "thick_shell", )" << body
                                  << "}}" << (sections.empty() ? "" : ", ") << sections << "}";
    return read_scene(path("p.json"));
  }
  std::unique_ptr<Model> model(const std::string& body = single, const std::string& sections = "") const {
    return build_model(scene(body, sections));
  }
  /// The message without the file it starts with.
  std::string error(const std::string& body, const std::string& sections = "") const {
    try {
      model(body, sections);
    } catch (const InputError& e) {
      const std::string text = e.what();
      EXPECT_EQ(text.find('\n'), std::string::npos);
      return text.substr(path("p.json").string().size() + 2);
    }
    return "no error";
  }
  std::string load_error(const std::string& load) const { return error(single, R"("loads": {"l": {)" + load + "}}"); }
};

Vector forces_of(const Energy& energy, const Vector& x) {
  Vector sum = Vector::Zero(x.size());
  std::vector<double> local(max_stencil_width), gradient(max_stencil_width);
  for (Index e = 0; e < energy.stencils().count(); ++e) {
    energy.stencils().gather(e, x, local.data());
    energy.evaluate(e, local.data(), gradient.data(), nullptr, Curvature::exact);
    for (int i = 0; i < energy.stencils().width(); ++i) sum[energy.stencils()[e][i]] -= gradient[i];
  }
  return sum;
}

Vector3 total(const Vector& forces) {
  return Eigen::Map<const Eigen::Matrix3Xd>(forces.data(), 3, forces.size() / 3).rowwise().sum();
}

TEST_F(BuildShell, HasTheNodesOfBothSurfacesAndTheirTriangles) {
  const auto built = model();
  ASSERT_EQ(built->positions.size(), 3 * 12);
  EXPECT_EQ(built->positions.segment<3>(0), Vector3(0, 0, -0.05));
  EXPECT_EQ(built->positions.segment<3>(3), Vector3(0, 0, 0.05));
  ASSERT_EQ(built->triangles.size(), 8u);
  EXPECT_EQ(built->triangles[0], (Triangle{0, 8, 2}));  // the bottom's normals point down
  EXPECT_EQ(built->triangles[4], (Triangle{1, 3, 9}));
  EXPECT_EQ(built->surfaces.size(), 8u);
  EXPECT_EQ(built->bodies[0].vertices, 12);
  EXPECT_EQ(built->bodies[0].levels, 2);
}

TEST_F(BuildShell, WeighsWhatItsLayersWeigh) {
  const std::string layers = grid + R"(, "layers": [{"thickness": 0.1, "density": 50, )" + solid +
                             R"(, "prisms": 2}, {"thickness": 0.2, "density": 20, )" + solid + "}]";
  for (const char* mass : {"lumped", "consistent"}) {
    const auto built = model(layers + R"(, "mass": ")" + mass + "\"", R"("gravity": [0, 0, -10])");
    EXPECT_EQ(built->positions.size(), 3 * 6 * 4);
    ASSERT_EQ(built->inertia.size(), 2u);
    ASSERT_EQ(built->elastic.size(), 2u);
    EXPECT_EQ(built->elastic[0]->stencils().count(), 8);
    EXPECT_EQ(built->elastic[1]->stencils().count(), 4);
    const Vector3 weight = total(forces_of(*built->dead_loads.at(0), built->positions));
    EXPECT_NEAR(weight.z(), -10 * 2 * (0.1 * 50 + 0.2 * 20), 1e-11) << mass;
  }
}

TEST_F(BuildShell, TurnsFibresAboutTheNormal) {
  const std::string layers = grid + R"(, "layers": [{"thickness": 0.1, "density": 1, "material": )" + ply + "}]";
  const auto built = model(layers);
  const auto& shell = dynamic_cast<const PrismShell&>(*built->elastic.at(0));
  Vector x = built->positions;
  for (Index v = 0; v < x.size() / 3; ++v) x[3 * v + 1] *= 1.01;  // along y, which is along the fibres
  std::vector<double> local(18);
  shell.stencils().gather(0, x, local.data());
  const PrismState state = shell.state(0, local.data(), Vector3::Constant(1.0 / 3), 0);
  EXPECT_NEAR(state.strain[0], (1.01 * 1.01 - 1) / 2, 1e-12);
  EXPECT_NEAR(state.strain[1], 0, 1e-12);
}

TEST_F(BuildShell, PinsTheSurfaceThatIsNamed) {
  const auto pinned = [&](const std::string& surface) {
    const auto built = model(single, R"("constraints": {"p": {"type": "pin", "body": "s", "axes": "z",
      "select": {"corners": ["x0y0"]})" + surface +
                                         "}}");
    std::vector<int> variables;
    for (const PinnedVariable& pin : built->pins) variables.push_back(pin.variable);
    return variables;
  };
  EXPECT_THAT(pinned(""), ElementsAre(2, 5));
  EXPECT_THAT(pinned(R"(, "surface": "both")"), ElementsAre(2, 5));
  EXPECT_THAT(pinned(R"(, "surface": "bottom")"), ElementsAre(2));
  EXPECT_THAT(pinned(R"(, "surface": "top")"), ElementsAre(5));
}

TEST_F(BuildShell, LimitsTheStretchOfItsSurfaces) {
  const auto triangles = [&](const std::string& surface) {
    const auto built =
        model(single, R"("constraints": {"l": {"type": "strain_limit", "body": "s", "max": 1.1)" + surface + "}}");
    return dynamic_cast<const MatrixStrainLimit&>(*built->constraints.at(0)).limit();
  };
  EXPECT_EQ(triangles("").triangles.size(), 8u);
  EXPECT_THAT(triangles(R"(, "surface": "bottom")").ids, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(triangles(R"(, "surface": "top")").ids, ElementsAre(4, 5, 6, 7));
}

TEST_F(BuildShell, SharesLoadsBetweenItsSurfaces) {
  const auto forces = [&](const std::string& load) {
    const auto built = model(single, R"("loads": {"l": {"body": "s", )" + load + "}}");
    return forces_of(*built->dead_loads.at(0), built->positions);
  };
  const Vector point = forces(R"("type": "point_load", "select": {"corners": ["x0y0"]}, "force": [0, 0, 3])");
  EXPECT_EQ(point[2], 1.5);
  EXPECT_EQ(point[5], 1.5);
  const Vector edge =
      forces(R"("type": "edge_load", "select": {"edges": ["x1"]}, "force_per_length": [0, 2, 0], "surface": "top")");
  EXPECT_EQ(total(edge), Vector3(0, 2, 0));
  EXPECT_EQ(edge.segment<3>(3 * 5), Vector3(0, 1, 0));  // top of vertex 2
  EXPECT_NEAR(total(forces(R"("type": "surface_load", "force_per_area": [0, 0, 7])")).z(), 14, 1e-12);
  const Vector waves = forces(R"("type": "surface_load", "force_per_area": [0, 0, 7], "half_waves": [[0.5, 0, 0]])");
  EXPECT_NEAR(waves[3 * 2 + 2] + waves[3 * 3 + 2] + waves[3 * 8 + 2] + waves[3 * 9 + 2], total(waves).z(), 1e-12);
  EXPECT_GT(total(waves).z(), 1);  // only the vertices at x = 1 carry it: sin(pi x/2) is 0 at the ends
}

TEST_F(BuildShell, PressesOnTheSurfaceThatIsNamed) {
  const std::string fine =
      R"("mesh": {"grid": {"size": [2, 1], "cells": [2, 2]}}, "thickness": 0.1, "density": 50, )" + solid;
  const auto pressed = [&](const std::string& held, const std::string& surface) {
    return R"("constraints": {"p": {"type": "pin", "body": "s", "select": {"boundary": true}, "surface": ")" + held +
           R"("}}, "loads": {"l": {"type": "pressure", "body": "s", "pressure": 3)" + surface + "}}";
  };
  for (const auto& [surface, level] : {std::pair{"top", 1}, std::pair{"bottom", 0}}) {
    const auto built = model(fine, pressed(surface, R"(, "surface": ")" + std::string(surface) + "\""));
    const Vector forces = forces_of(*built->pressures.at(0), built->positions);
    // All triangles are around the vertex in the middle, which gets a third of their force.
    EXPECT_LE((forces.segment<3>(3 * (2 * 4 + level)) - Vector3(0, 0, 3 * 2.0 / 3)).norm(), 1e-12) << surface;
    for (Index v = 0; v < 9; ++v) EXPECT_TRUE(forces.segment<3>(3 * (2 * v + 1 - level)).isZero(0)) << surface;
  }
}

TEST_F(BuildShell, LagsAPressureWithoutAPotentialAndSaysSo) {
  const auto built = model(single, R"("loads": {"l": {"type": "pressure", "body": "s", "pressure": 3}})");
  EXPECT_TRUE(built->pressures.empty());
  ASSERT_EQ(built->lagged_loads.size(), 1u);
  EXPECT_EQ(built->notes.at(0),
            "pressure l has no potential, because the boundary can move (vertex 0 of s along x): in "
            "each step its forces are those of the step's start");
  // Turned by a quarter about y, it pushes along x.
  Vector turned = built->positions, forces = Vector::Zero(turned.size());
  for (Index v = 0; v < turned.size(); v += 3)
    turned.segment<3>(v) = Vector3(turned[v + 2], turned[v + 1], -turned[v]).eval();
  built->lagged_loads[0].forces(turned, Vector::Zero(turned.size()), forces);
  EXPECT_LE((total(forces) - Vector3(6, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(forces.segment<3>(0).isZero(0));  // it is on the top
}

TEST_F(BuildShell, KeepsADeadPressureAsItIsAtRest) {
  const auto built =
      model(single, R"("loads": {"l": {"type": "pressure", "body": "s", "pressure": 3, "follows": false}})");
  EXPECT_TRUE(built->notes.empty());
  EXPECT_LE((total(forces_of(*built->dead_loads.at(0), 2 * built->positions)) - Vector3(0, 0, 6)).norm(), 1e-12);
}

TEST_F(BuildShell, TakesAThicknessPerVertex) {
  const std::string rest = R"(, "density": 1, )" + solid;
  const auto values = [&](const std::string& list) {
    return grid + R"(, "vertex_thickness": {"values": [)" + list + "]}" + rest;
  };
  const auto built = model(values("0.1, 0.2, 0.3, 0.1, 0.2, 0.3"));
  EXPECT_EQ(built->positions.segment<3>(3 * 5), Vector3(2, 0, 0.15));  // the top of vertex 2
  EXPECT_THAT(error(values("1, 2")),
              testing::HasSubstr("found 2 thicknesses, allowed: one for each of the 6 vertices"));
  EXPECT_THAT(error(values("1, 2, 0")), testing::HasSubstr("/bodies/s/vertex_thickness/values/2: found 0"));
  EXPECT_EQ(error(single + R"(, "vertex_thickness": {"values": [1]})"),
            "/bodies/s/thickness: found \"thickness\", allowed: either \"vertex_thickness\" or this");
  EXPECT_THAT(error(grid + R"(, "vertex_thickness": {"property": "t"})" + rest),
              testing::HasSubstr("found a property of a grid"));
}

TEST_F(BuildShell, TakesAThicknessFromAPropertyOfTheMesh) {
  std::ofstream(path("m.ply")) << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                  "property float z\nproperty float t\nelement face 1\nproperty list uchar int "
                                  "vertex_indices\nend_header\n0 0 0 0.5\n1 0 0 0.25\n0 1 0 1\n3 0 1 2\n";
  const std::string layers = R"(, "layers": [{"thickness": 1, "density": 1, )" + solid +
                             R"(}, {"thickness": 3, "density": 1, )" + solid + "}]";
  const std::string from = R"("mesh": {"file": "m.ply"}, "vertex_thickness": {"property": ")";
  const auto built = model(from + R"(t"})" + layers);
  for (int v = 0; v < 3; ++v) {
    const double thickness = std::array{0.5, 0.25, 1.0}[v];
    for (int level = 0; level < 3; ++level)
      EXPECT_NEAR(built->positions[3 * (3 * v + level) + 2], thickness * (std::array{0.0, 0.25, 1.0}[level] - 0.5),
                  1e-15);
  }
  EXPECT_THAT(error(from + R"(u"})" + layers), testing::HasSubstr("its vertices have no property \"u\""));
}

TEST_F(BuildShell, RefusesSurfacesThatCross) {
  // A strip folded over itself: two sheets, 0.1 m apart, joined by a wall at x = 1.
  std::ofstream(path("u.obj")) << "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 1 0 0.1\nv 1 1 0.1\nv 0 0 0.1\nv 0 1 0.1\n"
                                  "f 1 3 4\nf 1 4 2\nf 3 5 6\nf 3 6 4\nf 5 7 8\nf 5 8 6\n";
  const auto thick = [&](const std::string& t) {
    return R"("mesh": {"file": "u.obj"}, "density": 1, "thickness": )" + t + ", " + solid;
  };
  EXPECT_EQ(error(thick("0.04")), "no error");
  EXPECT_THAT(error(thick("0.11")),
              testing::MatchesRegex("/bodies/s/mesh: s: the .* of face [0-9]+ goes through the .* of "
                                    "face [0-9]+ near vertex [0-9]+"));
}

TEST_F(BuildShell, TurnsAnEdgeByTheWholeMoment) {
  const auto built = model(single, R"("loads": {"m": {"type": "end_moment", "body": "s", "select": {"edges": ["x1"]},
    "moment_per_length": [0, -3, 0]}})");
  const Vector forces = forces_of(*built->end_moments.at(0), built->positions);
  Vector3 moment = Vector3::Zero();
  for (Index v = 0; v < forces.size() / 3; ++v)
    moment += Vector3(built->positions.segment<3>(3 * v)).cross(Vector3(forces.segment<3>(3 * v)));
  EXPECT_LE((moment - Vector3(0, -3, 0)).norm(), 1e-12);
  EXPECT_LE(total(forces).norm(), 1e-12);
}

TEST_F(BuildShell, TakesTwoSurfaces) {
  std::ofstream(path("bottom.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(path("top.obj")) << "v 0 0 1\nv 1 0 2\nv 0 1 1\nf 1 2 3\n";
  std::ofstream(path("other.obj")) << "v 0 0 1\nv 1 0 2\nv 0 1 1\nf 2 3 1\n";
  const std::string rest = R"(, "density": 1, )" + solid;
  const auto built = model(R"("mesh": {"file": "bottom.obj"}, "top": {"file": "top.obj"})" + rest);
  EXPECT_EQ(built->positions.segment<3>(9), Vector3(1, 0, 2));
  EXPECT_THAT(error(R"("mesh": {"file": "bottom.obj"}, "top": {"file": "other.obj"})" + rest),
              testing::HasSubstr("found another mesh than the bottom's, allowed: the same triangles"));
  EXPECT_THAT(error(R"("mesh": {"file": "top.obj"}, "top": {"file": "bottom.obj"})" + rest),
              testing::HasSubstr("inverted at vertex"));
  const Scene first = scene(R"("mesh": {"file": "bottom.obj"}, "top": {"file": "top.obj"})" + rest);
  std::ofstream(path("top.obj")) << "v 0 0 1\nv 1 0 3\nv 0 1 1\nf 1 2 3\n";
  EXPECT_NE(first.hash, scene(R"("mesh": {"file": "bottom.obj"}, "top": {"file": "top.obj"})" + rest).hash);
}

TEST_F(BuildShell, CorrectsShearOfASinglePrismOnly) {
  EXPECT_EQ(scene().bodies[0].shell->options.shear_correction, 5.0 / 6);
  const std::string two = grid + R"(, "layers": [{"thickness": 1, "density": 1, "prisms": 2, )" + solid + "}]";
  EXPECT_EQ(scene(two).bodies[0].shell->options.shear_correction, 1);
  EXPECT_EQ(scene(single + R"(, "shell": {"element": "plain"})").bodies[0].shell->options.element, PrismElement::plain);
}

TEST_F(BuildShell, RefusesWhatItCannotMean) {
  EXPECT_EQ(
      error(grid + R"(, "density": 1, )" + solid),
      "/bodies/s/thickness: missing, allowed: a number > 0, in m (or \"layers\", \"top\" or \"vertex_thickness\")");
  EXPECT_EQ(error(grid + R"(, "density": 1, "thickness": 1)"),
            "/bodies/s/material: missing, allowed: an object (or \"layers\")");
  EXPECT_EQ(error(single + R"(, "bending": {"stiffness": 1})"),
            "/bodies/s/bending: found \"bending\", allowed: none of it where \"model\" is \"thick_shell\"");
  EXPECT_EQ(error(single + R"(, "layers": [{"thickness": 1, "density": 1, )" + solid + "}]"),
            "/bodies/s/thickness: found \"thickness\", allowed: either \"layers\" or this");
  EXPECT_EQ(error(single + R"(, "shell": {"points_in_plane": 2})"),
            "/bodies/s/shell/points_in_plane: found 2, allowed: 1, 3, 6");
  EXPECT_EQ(error(single + R"(, "shell": {"element": "plain", "shear_stabilisation": 0.1})"),
            "/bodies/s/shell/shear_stabilisation: found 0.1, allowed: 0 for the plain element");
  EXPECT_EQ(error(single, R"("constraints": {"p": {"type": "pin", "body": "s", "select": {"all": true},
              "surface": "mid"}})"),
            "/constraints/p/surface: found \"mid\" of s, which has 1 prisms through its thickness, allowed: both, "
            "bottom, top (no node is in the middle of an odd number of prisms)");
  EXPECT_EQ(
      load_error(R"("type": "end_moment", "body": "s", "select": {"edges": ["x1"]}, "moment_per_length": [0, 0, 1])"),
      "/loads/l/moment_per_length: found an axis along the thickness of s, allowed: one across it");
  EXPECT_EQ(error(grid + R"(, "thickness": 1, "density": 1, "material": {"law": "stvk", "young_modulus": 1,
              "poisson_ratio": 0.5})"),
            "/bodies/s/material/poisson_ratio: found 0.5, allowed: a number > -1 and < 0.5");
  const std::string bad_ply = R"("E_L": 1, "E_T": 1, "G_LT": 1, "G_TT": 1, "nu_LT": 2, "nu_TT": 0)";
  EXPECT_EQ(error(grid + R"(, "thickness": 1, "density": 1, "material": {)" + bad_ply + "}"),
            "/bodies/s/material: found moduli whose elasticity is not positive definite, allowed: those of an elastic "
            "solid, such as nu_LT^2 < E_L/E_T and |nu_TT| < 1");
  EXPECT_EQ(error(grid + R"(, "thickness": 1, "density": 1, "shell": {"direction": [0, 0, 1]}, "material": )" + ply),
            "/bodies/s/shell/direction: found the normal of triangle 0, allowed: a direction that has a part in every "
            "triangle");
}

TEST_F(BuildShell, LeavesClothWithoutSurfaces) {
  std::ofstream(path("p.json")) << R"({"format": 1, "time": {"integrator": "static", "steps": 1},
    "bodies": {"c": {"thickness": 1, "density": 1, )"
                                << grid << R"(}}, "constraints": {"p": {"type": "pin",
    "body": "c", "select": {"all": true}, "surface": "top"}}})";
  EXPECT_THROW(
      {
        try {
          read_scene(path("p.json"));
        } catch (const InputError& e) {
          EXPECT_THAT(e.what(), testing::HasSubstr("found \"top\" of c, which is cloth, allowed: surfaces of thick "
                                                   "shells only"));
          throw;
        }
      },
      InputError);
}

}  // namespace
}  // namespace taut
