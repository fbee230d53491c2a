#include "study/acceleration_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>
#include <tuple>

#include "files/svg_chart.h"

namespace taut {
namespace {

auto key_of(const StreamHeader& h) { return std::tuple(h.stream, h.step, h.beta, h.gamma, h.modes); }

StreamHeader commonest_header(const std::vector<StreamPacket>& packets) {
  std::map<decltype(key_of(StreamHeader{})), int> counts;
  StreamHeader best;
  int most = 0;
  for (const StreamPacket& packet : packets) {
    const int count = ++counts[key_of(packet.header)];
    if (count > most) {
      most = count;
      best = packet.header;
    }
  }
  return best;
}

}  // namespace

ReceivedStream received_stream(const std::vector<StreamPacket>& packets, std::uint64_t skipped_bytes) {
  ReceivedStream stream;
  stream.header = commonest_header(packets);
  stream.skipped_bytes = skipped_bytes;
  int last = 0;
  for (const StreamPacket& packet : packets) {
    if (packet.header != stream.header) {
      ++stream.foreign;
      continue;
    }
    const int step = static_cast<int>(std::min<std::uint32_t>(packet.step, 1u << 30));
    if (packet.kind == StreamPacket::Kind::end) {
      stream.steps = step;
      stream.ended = true;
      continue;
    }
    last = std::max(last, step);
    auto& kind = packet.kind == StreamPacket::Kind::keyframe ? stream.keyframes : stream.accelerations;
    if (!kind.emplace(step, packet).second) ++stream.duplicates;
  }
  if (!stream.ended) stream.steps = last;
  return stream;
}

ReceivedStream read_stream(std::string_view bytes) {
  PacketReader reader;
  reader.add(bytes);
  reader.finish();
  std::vector<StreamPacket> packets;
  while (auto packet = reader.next()) packets.push_back(std::move(*packet));
  return received_stream(packets, reader.skipped());
}

RebuiltStream rebuild(const ReceivedStream& stream, Fill fill) {
  if (stream.keyframes.empty()) throw std::runtime_error("no keyframe arrived, so there is no state to begin from");
  const auto& [first, start] = *stream.keyframes.begin();
  RebuiltStream rebuilt{stream.rule(), first, {}, {}};
  Replay replay(rebuilt.rule, {start.q, start.v, start.a}, fill);
  rebuilt.states.push_back(replay.state());
  for (int step = first + 1; step <= stream.steps; ++step) {
    const auto packet = stream.accelerations.find(step);
    if (packet != stream.accelerations.end()) {
      replay.advance(packet->second.a);
    } else {
      replay.advance({});
      rebuilt.lost.push_back(step);
    }
    const auto keyframe = stream.keyframes.find(step);
    if (keyframe != stream.keyframes.end())
      replay.correct({keyframe->second.q, keyframe->second.v, keyframe->second.a});
    rebuilt.states.push_back(replay.state());
  }
  return rebuilt;
}

std::vector<StreamPacket> sent(const ReceivedStream& original, const Channel& channel) {
  if (!(channel.loss >= 0 && channel.loss <= 1)) throw std::invalid_argument("Channel: loss must be in [0, 1]");
  if (channel.keyframe < 0) throw std::invalid_argument("Channel: keyframe must be at least 0");
  const RebuiltStream states = rebuild(original, Fill::zero);
  const std::set<int> dropped(channel.drop.begin(), channel.drop.end());
  std::mt19937 random(channel.seed);
  // Not a standard distribution, whose numbers differ between libraries.
  const auto uniform = [&random] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<StreamPacket> packets;
  const auto add_keyframe = [&](int step) {
    const SpectralState& state = states.states[static_cast<std::size_t>(step - states.first_step)];
    packets.push_back(
        {original.header, StreamPacket::Kind::keyframe, static_cast<std::uint32_t>(step), state.q, state.v, state.a});
  };
  add_keyframe(states.first_step);
  for (const auto& [step, packet] : original.accelerations) {
    const bool lost = uniform() < channel.loss || dropped.contains(step);
    if (step <= states.first_step || step > original.steps) continue;
    if (!lost) packets.push_back(packet);
    if (channel.keyframe > 0 && step % channel.keyframe == 0) add_keyframe(step);
  }
  packets.push_back({original.header, StreamPacket::Kind::end, static_cast<std::uint32_t>(original.steps), {}, {}, {}});
  return packets;
}

std::vector<Distortion> distortions(const RebuiltStream& original, const RebuiltStream& rebuilt) {
  if (original.states.empty() || rebuilt.states.empty() || original.states[0].q.size() != rebuilt.states[0].q.size()) {
    throw std::invalid_argument("distortions: the trajectories have different modes");
  }
  const std::set<int> lost(rebuilt.lost.begin(), rebuilt.lost.end());
  std::vector<Distortion> lines;
  for (std::size_t k = 0; k < rebuilt.states.size(); ++k) {
    const int step = rebuilt.first_step + static_cast<int>(k), at = step - original.first_step;
    if (at < 0 || at >= static_cast<int>(original.states.size())) continue;
    const SpectralState &truth = original.states[static_cast<std::size_t>(at)], &found = rebuilt.states[k];
    lines.push_back(
        {step, step * rebuilt.rule.step, lost.contains(step), (found.q - truth.q).norm(), (found.v - truth.v).norm()});
  }
  return lines;
}

std::string distortion_csv(const std::vector<Distortion>& distortions) {
  std::string text = "step,time,lost,displacement,velocity\n";
  for (const Distortion& d : distortions)
    text += fmt::format("{},{},{},{},{}\n", d.step, d.time, d.lost ? 1 : 0, d.displacement, d.velocity);
  return text;
}

std::string trajectory_csv(const RebuiltStream& stream) {
  std::string text = "step,time";
  for (Index k = 0; k < (stream.states.empty() ? 0 : stream.states[0].q.size()); ++k)
    text += fmt::format(",q{}", k + 1);
  text += "\n";
  for (std::size_t i = 0; i < stream.states.size(); ++i) {
    const int step = stream.first_step + static_cast<int>(i);
    text += fmt::format("{},{}", step, step * stream.rule.step);
    for (const double q : stream.states[i].q) text += fmt::format(",{}", q);
    text += "\n";
  }
  return text;
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
