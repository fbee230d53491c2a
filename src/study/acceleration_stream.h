#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "study/stream_receiver.h"

namespace taut {

/// What happens to packets on the way. Accelerations only are lost.
struct Channel {
  double loss = 0;        ///< probability of each
  std::vector<int> drop;  ///< steps that are lost for certain
  unsigned seed = 1;
  int keyframe = 0;  ///< every how many steps the sender puts the whole state in; 0: only at the start

  bool changes() const { return loss > 0 || !drop.empty() || keyframe > 0; }
};

/// Sends the frames of a stream through a channel.
class StreamSender {
 public:
  /// Throws std::invalid_argument for a loss outside [0, 1] or a negative number.
  explicit StreamSender(const Channel& channel);

  /// What leaves the channel of a frame: the first one as a keyframe; of others a keyframe where one is due, and the
  /// acceleration unless it is lost. The keyframe goes first: the acceleration may make the frame certain.
  std::vector<StreamPacket> packets(const StreamHeader& header, const StreamFrame& frame);
  /// The end packet of a stream whose last step this is.
  static StreamPacket end(const StreamHeader& header, int step);

 private:
  double loss_;
  std::set<int> dropped_;
  int keyframe_;
  std::mt19937 random_;
  bool begun_ = false;
};

/// A trajectory that was rebuilt as a whole.
struct RebuiltStream {
  StreamHeader header;
  std::vector<StreamFrame> frames;  ///< none: no keyframe arrived
  StreamReceiver::Counts counts;
  std::uint64_t skipped_bytes = 0;  ///< that belonged to no packet
};

/// Rebuilds what `bytes` hold, in whatever order.
RebuiltStream read_stream(std::string_view bytes, Fill fill = Fill::zero);

/// How far a frame is from the original.
struct Distortion {
  int step = 0;
  double time = 0;  ///< s
  bool lost = false;
  double displacement = 0;  ///< |dq|, kg^(1/2) m
  double velocity = 0;      ///< |dv|, kg^(1/2) m/s
};
/// `step` is h, s. Throws std::invalid_argument for an original of other modes.
Distortion distortion(const StreamFrame& frame, const SpectralState& original, double step);

/// Lines of distortion.csv (step,time,lost,displacement,velocity) and of trajectory.csv (step,time,q1,q2,...).
std::string distortion_header();
std::string distortion_line(const Distortion& distortion);
std::string trajectory_header(int modes);
std::string trajectory_line(const StreamFrame& frame, double step);
/// Writes |dq| over time as an SVG, losses marked. Throws FileError.
void write_distortion_chart(const std::filesystem::path& path, const std::vector<Distortion>& distortions,
                            const std::string& title);

}  // namespace taut
