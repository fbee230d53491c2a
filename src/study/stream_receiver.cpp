#include "study/stream_receiver.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace taut {
namespace {

constexpr int last_step = 1 << 30;
constexpr int farthest = 1 << 20;  // steps ahead of all others that a packet may be

}  // namespace

StreamReceiver::StreamReceiver(Fill fill, int window) : fill_(fill), window_(window) {
  if (window < 1)
    throw std::invalid_argument("StreamReceiver: window must be at least 1, got " + std::to_string(window));
}

void StreamReceiver::take(StreamPacket packet) {
  if (packet.step > static_cast<std::uint32_t>(last_step)) {
    ++counts_.foreign;
    return;
  }
  if (header_) return sort_in(std::move(packet));
  early_.push_back(std::move(packet));
  if (early_.back().kind == StreamPacket::Kind::keyframe) {
    header_ = early_.back().header;
    newest_ = static_cast<int>(early_.back().step);
    for (StreamPacket& early : std::exchange(early_, {})) sort_in(std::move(early));
  } else if (static_cast<int>(early_.size()) > window_) {
    early_.erase(early_.begin());
    ++counts_.late;
  }
}

void StreamReceiver::sort_in(StreamPacket packet) {
  if (packet.header != *header_ || static_cast<int>(packet.step) > newest_ + farthest) {
    ++counts_.foreign;
    return;
  }
  const int step = static_cast<int>(packet.step);
  newest_ = std::max(newest_, step);
  if (packet.kind == StreamPacket::Kind::end) {
    if (!end_) end_ = step;
    return;
  }
  const bool certain = replay_ && step <= done_;
  if (certain && (step <= done_ - window_ || step < first_)) {
    ++counts_.late;
    return;
  }
  Arrived& arrived = arrived_[step];
  if (packet.kind == StreamPacket::Kind::acceleration) {
    if (arrived.acceleration) {
      ++counts_.duplicates;
    } else {
      arrived.acceleration = std::move(packet.a);
      if (certain) ++counts_.late;
    }
    return;
  }
  if (arrived.keyframe) {
    ++counts_.duplicates;
    return;
  }
  arrived.keyframe = SpectralState{std::move(packet.q), std::move(packet.v), std::move(packet.a)};
  ++counts_.keyframes;
  if (certain) correct_from(step);
}

/// Begins with the first keyframe, once no earlier one can come.
bool StreamReceiver::begin() {
  const auto first =
      std::find_if(arrived_.begin(), arrived_.end(), [](const auto& entry) { return entry.second.keyframe; });
  if (first == arrived_.end() || (first->first > 0 && !given_up(first->first))) return false;
  first_ = done_ = first->first;
  replay_.emplace(rule(), *first->second.keyframe, fill_);
  arrived_.erase(arrived_.begin(), first);
  return true;
}

std::optional<StreamFrame> StreamReceiver::next() {
  bool lost = false;
  if (!replay_) {
    if (!begin()) return {};
  } else {
    if (done_ >= end_.value_or(newest_)) return {};
    const auto found = arrived_.find(done_ + 1);
    lost = found == arrived_.end() || !found->second.acceleration;
    if (lost && !given_up(done_ + 1)) return {};
    ++done_;
    advance(*replay_, done_);
    arrived_.erase(arrived_.begin(), arrived_.upper_bound(done_ - window_));
  }
  ++counts_.frames;
  counts_.lost += lost ? 1 : 0;
  return StreamFrame{done_, lost, replay_->state()};
}

void StreamReceiver::advance(Replay& replay, int step) const {
  const auto found = arrived_.find(step);
  if (found == arrived_.end()) return replay.advance({});
  replay.advance(found->second.acceleration);
  if (found->second.keyframe) replay.correct(*found->second.keyframe);
}

void StreamReceiver::correct_from(int step) {
  Replay again(rule(), *arrived_.at(step).keyframe, fill_);
  for (int k = step + 1; k <= done_; ++k) advance(again, k);
  replay_ = std::move(again);
}

}  // namespace taut
