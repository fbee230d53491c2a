#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "dynamics/modal/replay.h"
#include "files/acceleration_packets.h"

namespace taut {

/// What arrived of a stream, in whatever order: of packets of one kind and step the first counts.
struct ReceivedStream {
  StreamHeader header;
  int steps = 0;       ///< by its end packet, or the last step that anything is known of
  bool ended = false;  ///< the end packet arrived
  std::map<int, StreamPacket> accelerations, keyframes;  ///< by step
  std::uint64_t skipped_bytes = 0;                       ///< that belonged to no packet
  int duplicates = 0, foreign = 0;                       ///< packets of a step that was there; of another stream

  NewmarkRule rule() const { return {header.step, header.beta, header.gamma}; }
};

/// Sorts packets into a stream. Those of another header than most have are foreign.
ReceivedStream received_stream(const std::vector<StreamPacket>& packets, std::uint64_t skipped_bytes);
ReceivedStream read_stream(std::string_view bytes);

/// A trajectory that was rebuilt.
struct RebuiltStream {
  NewmarkRule rule;
  int first_step = 0;                 ///< of the first keyframe, where it begins
  std::vector<SpectralState> states;  ///< of first_step, first_step + 1, ...
  std::vector<int> lost;              ///< steps whose acceleration did not arrive
};

/// Throws std::runtime_error where no keyframe arrived, from which it could begin.
RebuiltStream rebuild(const ReceivedStream& stream, Fill fill);

/// What happens to packets on the way. Accelerations only are lost.
struct Channel {
  double loss = 0;        ///< probability of each
  std::vector<int> drop;  ///< steps that are lost for certain
  unsigned seed = 1;
  int keyframe = 0;  ///< every how many steps the sender puts the whole state in; 0: only at the start

  bool changes() const { return loss > 0 || !drop.empty() || keyframe > 0; }
};

/// The packets of a complete stream as they leave the channel, in order. Throws std::invalid_argument for a loss
/// outside [0, 1] or a negative number.
std::vector<StreamPacket> sent(const ReceivedStream& original, const Channel& channel);

/// How far a rebuilt trajectory is from the original, a line per step that both have.
struct Distortion {
  int step = 0;
  double time = 0;  ///< s
  bool lost = false;
  double displacement = 0;  ///< |dq|, kg^(1/2) m
  double velocity = 0;      ///< |dv|, kg^(1/2) m/s
};
std::vector<Distortion> distortions(const RebuiltStream& original, const RebuiltStream& rebuilt);

/// Header "step,time,lost,displacement,velocity", then a line each.
std::string distortion_csv(const std::vector<Distortion>& distortions);
/// Header "step,time,q1,q2,...", then a line each.
std::string trajectory_csv(const RebuiltStream& stream);
/// Writes |dq| over time as an SVG, losses marked. Throws FileError.
void write_distortion_chart(const std::filesystem::path& path, const std::vector<Distortion>& distortions,
                            const std::string& title);

}  // namespace taut
