#include "study/acceleration_record.h"

#include <fcntl.h>

#include <string>

namespace taut {
namespace {

StreamHeader header_of(const Scene& scene) {
  const bool modal = scene.bodies.size() == 1 && scene.bodies[0].modal;
  if (!modal) throw InputError(scene.source, "/bodies", "found no modal body, whose accelerations could be recorded");
  if (scene.time.integrator != scene::Integrator::newmark)
    throw InputError(scene.source, "/time/integrator",
                     "found another than \"newmark\", allowed: it, to record accelerations");
  StreamHeader header;
  header.stream = std::stoull(scene.hash, nullptr, 16);
  header.step = scene.time.step;
  header.beta = scene.time.beta;
  header.gamma = scene.time.gamma;
  header.modes = scene.bodies[0].modal->modes;
  return header;
}

}  // namespace

AccelerationRecord::AccelerationRecord(const Scene& scene, const std::filesystem::path& file)
    : header_(header_of(scene)), file_(file, O_WRONLY | O_CREAT | O_TRUNC) {}

void AccelerationRecord::write(StreamPacket packet) {
  packet.header = header_;
  file_.write(encode_packet(packet));
}

void AccelerationRecord::take(const State& before, const State& after) {
  if (after.step == 1)
    write({{}, StreamPacket::Kind::keyframe, 0, before.positions, before.velocities, after.accelerations});
  steps_ = after.step;
  write({{}, StreamPacket::Kind::acceleration, static_cast<std::uint32_t>(after.step), {}, {}, after.accelerations});
}

void AccelerationRecord::finish() {
  write({{}, StreamPacket::Kind::end, static_cast<std::uint32_t>(steps_), {}, {}, {}});
  file_.sync();
}

}  // namespace taut
