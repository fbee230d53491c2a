#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "files/vtu.h"
#include "problems/scene.h"

namespace taut {

/// How much of a run the viewer gets, so that a browser still opens the page.
struct ViewerLimits {
  int frames = 60;                 ///< at most, evenly over the run, the first and the last included
  long long vertices = 1'000'000;  ///< in all frames together; two frames are kept in any case
};

/// What the 3D viewer of a report shows of the run in `folder`, or null where that has no frames.
///
/// "vertices", "triangles", "positions" (box "low" and "high", m), "frames" (step and time), "fields" of triangles with
/// their units and colour scale (the largest singular value; tension in N/m where the frames have it; the violation of
/// each constraint, in its own units, as the model judges the positions), "layers" (ranges of triangles), "worst" (the
/// elements that are worst in any of these frames), "spheres" and "pins", "up" and "view", "picture" (the run's last
/// SVG) and "note", a sentence on what was left out. Arrays are {"type", "data"} with little-endian integers in
/// packed_text(); positions and fields are fractions of their range in 16 bits, the highest number of a field standing
/// for no value, and every frame but the first is the difference modulo 2^16 to the one before it.
///
/// Throws FileError or MeshError for a frame that is damaged or not of this scene, InputError for a scene that cannot
/// be built.
nlohmann::json viewer_data(const std::filesystem::path& folder, const Scene& scene, const ViewerLimits& limits = {});

/// A frame of a scene that is read where it is shown.
struct ViewerFrame {
  int step = 0;
  std::function<Frame()> read;
  std::string source;  ///< for errors: the file
};

/// Other positions of the same scene's vertices after a step, m, 3 entries each; nothing where there are none.
struct OtherPositions {
  std::string name;
  std::function<std::optional<Vector>(int step)> at;
};

/// The same of any frames, in the order of their steps and without a picture. Each of `others` that differs somewhere
/// is one more field: how far the vertices of a triangle are from where they are there, m, the largest distance.
nlohmann::json viewer_data(const Scene& scene, const std::vector<ViewerFrame>& frames,
                           const std::vector<OtherPositions>& others = {}, const ViewerLimits& limits = {});

}  // namespace taut
