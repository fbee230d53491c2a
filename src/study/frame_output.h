#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/modal/natural_modes.h"
#include "dynamics/model.h"
#include "dynamics/stepper.h"
#include "problems/scene.h"
#include "study/surface_fields.h"

namespace taut {

/// Writes the frames and pictures of a run: FOLDER/frames/NAME_00010.vtu (or .obj), FOLDER/NAME.pvd,
/// FOLDER/pictures/NAME_00100.svg, FOLDER/modes/NAME_mode_00001.vtu.
class FrameOutput {
 public:
  /// Scene and model are borrowed. Frames that the folder has of steps up to `last_step` count as written, later ones
  /// are removed.
  FrameOutput(const Scene& scene, const Model& model, std::filesystem::path folder, int last_step);

  /// True for steps 0, every, 2 every, ... and the last.
  bool frame_is_due(int step) const;
  /// True for output.pictures steps, evenly over the run, the last included.
  bool picture_is_due(int step) const;
  void write_frame(const State& state);
  /// One file a mode in FOLDER/modes, its shape as `displacement` on the state, largest displacement 1.
  void write_modes(const State& state, const std::vector<NaturalMode>& modes) const;
  /// Returns what went wrong, or nothing: a picture never fails a run.
  std::string write_picture(const State& state) const;
  /// Brings the PVD up to date.
  void write_index() const;

 private:
  const Scene& scene_;
  const Model& model_;
  std::filesystem::path folder_;
  std::string name_, extension_;
  SurfaceFields fields_;
  std::vector<std::pair<double, std::string>> frames_;  // time and path in the folder
};

/// Time at the end of a step, s; of static problems the load fraction.
double time_of(const Scene& scene, int step);

/// The name of a scene with everything but letters, digits, '.', '-' and '_' replaced by '_'.
std::string file_name(const std::string& scene_name);

/// Removes frames and pictures that a run has left in the folder and whose step is larger than `last_step`, and, with
/// last_step below 0, PVD files.
void remove_frames_after(const std::filesystem::path& folder, int last_step);

}  // namespace taut
