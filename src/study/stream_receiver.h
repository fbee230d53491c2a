#pragma once

#include <map>
#include <optional>
#include <vector>

#include "dynamics/modal/replay.h"
#include "files/acceleration_packets.h"

namespace taut {

/// A step of a rebuilt trajectory.
struct StreamFrame {
  int step = 0;
  bool lost = false;  ///< its acceleration did not arrive in time
  SpectralState state;
};

/// Rebuilds a trajectory from a stream while it arrives. A frame is certain, and never taken back, as soon as its
/// packet and all before it are there, or a packet `window` steps later is: what is missing by then is lost.
///
/// The stream is that of the first keyframe; packets with another header are foreign. The trajectory begins with the
/// first keyframe in order of steps. A keyframe that comes after its frame became certain still corrects the frames to
/// come. At most about two windows of packets are held.
class StreamReceiver {
 public:
  /// Throws std::invalid_argument unless window >= 1.
  StreamReceiver(Fill fill, int window);

  /// In whatever order they come. Whoever adds packets takes frames out.
  void take(StreamPacket packet);
  /// No more will come: what is missing up to the end packet, or else the last known step, is lost.
  void finish() { finished_ = true; }
  /// The next frame, or nothing until it is certain.
  std::optional<StreamFrame> next();

  /// Known from the first keyframe on.
  const std::optional<StreamHeader>& header() const { return header_; }
  NewmarkRule rule() const { return {header_->step, header_->beta, header_->gamma}; }
  bool ended() const { return end_.has_value(); }  ///< the end packet has come
  /// The end packet has come, and all frames are certain.
  bool complete() const { return end_ && replay_ && done_ >= *end_; }

  struct Counts {
    int frames = 0, lost = 0, keyframes = 0;
    int duplicates = 0;  ///< of one kind and step the first counts
    int late = 0;        ///< came when their frame was certain, or before the stream began
    int foreign = 0;     ///< of another stream, or of a step that cannot be
  };
  const Counts& counts() const { return counts_; }

 private:
  struct Arrived {
    std::optional<Vector> acceleration;
    std::optional<SpectralState> keyframe;
  };
  void sort_in(StreamPacket packet);
  bool begin();
  void advance(Replay& replay, int step) const;
  void correct_from(int step);
  /// No packet of this step is still waited for.
  bool given_up(int step) const { return finished_ || newest_ - step >= window_; }

  Fill fill_;
  int window_;
  std::optional<StreamHeader> header_;
  std::vector<StreamPacket> early_;  // before the first keyframe
  std::map<int, Arrived> arrived_;   // by step, from a window before the last certain frame on
  std::optional<Replay> replay_;
  std::optional<int> end_;
  int first_ = 0, done_ = 0, newest_ = 0;  // first and last certain step; last one that anything is known of
  bool finished_ = false;
  Counts counts_;
};

}  // namespace taut
