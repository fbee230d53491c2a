#pragma once

#include <optional>
#include <vector>

#include "core/constraint.h"
#include "dynamics/model.h"
#include "dynamics/stepper.h"
#include "files/vtu.h"
#include "geometry/rest_shape.h"

namespace taut {

/// What a frame shows of a state. At points: velocity (m/s), body (its number) and displacement (m, from the start). In
/// cells, from the membranes, the surfaces of thick shells and the strain limits of the model: sigma_max and sigma_min
/// (singular values; NaN where no rest shape is known), tension (N/m) and active (1 where a multiplier of a strain
/// limit is not zero).
///
/// The tension is the largest eigenvalue of 2 Lambda for limits of matrix form, the largest multiplier for those of
/// singular values; 0 without a limit.
///
/// Of thick shells, in the axes of ShellSection: N (N11, N22, N12 in N/m), M (M11, M22, M12 in N) and Q (Q1, Q2 in
/// N/m), the same on the bottom and the top triangle; of each layer k stress_k (six, in Voigt's order, Pa) and
/// stretches_k (three, the largest first), on the bottom triangle at the bottom of the layer and on the top one at its
/// top. NaN elsewhere.
class SurfaceFields {
 public:
  /// The model is borrowed. With `stresses` a frame has those of thick shells too.
  explicit SurfaceFields(const Model& model, bool stresses = false);

  Frame frame(const State& state, double time) const;
  /// The largest singular value of each triangle at these positions.
  std::vector<double> largest_stretch(const Vector& positions) const;
  /// The smallest upper limit of any strain limit, if there is one.
  std::optional<double> upper_limit() const { return upper_limit_; }

 private:
  struct Limit {
    std::size_t constraint;      // its place in Model::constraints
    bool matrix;                 // its form
    std::vector<int> triangles;  // of each element
  };
  std::vector<Vector2> stretches(const Vector& positions) const;
  Field coupling_force(const State& state) const;

  const Model& model_;
  bool stresses_;
  std::vector<const RestTriangle*> rest_;  // of each triangle of the model, or null
  std::vector<Limit> limits_;
  std::optional<double> upper_limit_;
};

}  // namespace taut
