#pragma once

#include <filesystem>
#include <string>

#include "dynamics/stepper.h"
#include "files/acceleration_packets.h"
#include "files/descriptor.h"
#include "problems/scene.h"

namespace taut {

/// Writes the spectral accelerations of a run of a modal body as a stream of packets: a keyframe with the initial
/// state, one packet a step, one that ends it. The initial acceleration is that of the first step, with which Newmark's
/// formulas of any beta and gamma give the run's first step.
class AccelerationRecord {
 public:
  /// Throws InputError for a scene that is not of a modal body under `newmark`, FileError.
  AccelerationRecord(const Scene& scene, const std::filesystem::path& file);

  /// Takes one finished step: the states before and after it.
  void take(const State& before, const State& after);
  void finish();

 private:
  void write(StreamPacket packet);

  StreamHeader header_;
  Descriptor file_;
  int steps_ = 0;
};

}  // namespace taut
