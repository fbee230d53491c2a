#include "study/acceleration_stream.h"

#include <fmt/format.h>

#include <limits>
#include <stdexcept>

#include "files/svg_chart.h"

namespace taut {

StreamSender::StreamSender(const Channel& channel)
    : loss_(channel.loss),
      dropped_(channel.drop.begin(), channel.drop.end()),
      keyframe_(channel.keyframe),
      random_(channel.seed) {
  if (!(loss_ >= 0 && loss_ <= 1)) throw std::invalid_argument("Channel: loss must be in [0, 1]");
  if (keyframe_ < 0) throw std::invalid_argument("Channel: keyframe must be at least 0");
}

std::vector<StreamPacket> StreamSender::packets(const StreamHeader& header, const StreamFrame& frame) {
  using Kind = StreamPacket::Kind;
  const auto step = static_cast<std::uint32_t>(frame.step);
  const auto& [q, v, a] = frame.state;
  std::vector<StreamPacket> packets;
  const bool first = !begun_;
  begun_ = true;
  if (first || (keyframe_ > 0 && frame.step % keyframe_ == 0))
    packets.push_back({header, Kind::keyframe, step, q, v, a});
  if (first || frame.lost) return packets;
  // Not a standard distribution, whose numbers differ between libraries.
  const bool lost = static_cast<double>(random_()) / 4294967296.0 < loss_;
  if (!lost && !dropped_.contains(frame.step)) packets.push_back({header, Kind::acceleration, step, {}, {}, a});
  return packets;
}

StreamPacket StreamSender::end(const StreamHeader& header, int step) {
  return {header, StreamPacket::Kind::end, static_cast<std::uint32_t>(step), {}, {}, {}};
}

RebuiltStream read_stream(std::string_view bytes, Fill fill) {
  PacketReader reader;
  reader.add(bytes);
  reader.finish();
  StreamReceiver receiver(fill, std::numeric_limits<int>::max() / 4);
  while (auto packet = reader.next()) receiver.take(std::move(*packet));
  receiver.finish();
  RebuiltStream rebuilt;
  while (auto frame = receiver.next()) rebuilt.frames.push_back(std::move(*frame));
  rebuilt.header = receiver.header().value_or(StreamHeader{});
  rebuilt.counts = receiver.counts();
  rebuilt.skipped_bytes = reader.skipped();
  return rebuilt;
}

Distortion distortion(const StreamFrame& frame, const SpectralState& original, double step) {
  if (frame.state.q.size() != original.q.size())
    throw std::invalid_argument("distortion: the trajectories have different modes");
  return {frame.step, frame.step * step, frame.lost, (frame.state.q - original.q).norm(),
          (frame.state.v - original.v).norm()};
}

std::string distortion_header() { return "step,time,lost,displacement,velocity\n"; }

std::string distortion_line(const Distortion& d) {
  return fmt::format("{},{},{},{},{}\n", d.step, d.time, d.lost ? 1 : 0, d.displacement, d.velocity);
}

std::string trajectory_header(int modes) {
  std::string text = "step,time";
  for (int k = 1; k <= modes; ++k) text += fmt::format(",q{}", k);
  return text + "\n";
}

std::string trajectory_line(const StreamFrame& frame, double step) {
  std::string text = fmt::format("{},{}", frame.step, frame.step * step);
  for (const double q : frame.state.q) text += fmt::format(",{}", q);
  return text + "\n";
}

void write_distortion_chart(const std::filesystem::path& path, const std::vector<Distortion>& distortions,
                            const std::string& title) {
  Chart chart;
  chart.title = title;
  chart.x.name = "time, s";
  chart.y.name = "|dq|, kg^(1/2) m";
  chart.lines.emplace_back().name = "displacement";
  chart.ticks_name = "lost";
  for (const Distortion& d : distortions) {
    chart.lines[0].x.push_back(d.time);
    chart.lines[0].y.push_back(d.displacement);
    if (d.lost) chart.ticks.push_back(d.time);
  }
  write_chart(path, chart);
}

}  // namespace taut
