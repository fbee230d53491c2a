#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/types.h"

namespace taut {

/// What every packet of a stream of accelerations repeats, so that each can be read alone.
struct StreamHeader {
  std::uint64_t stream = 0;  ///< which stream: packets of others are ignored
  double step = 0;           ///< h, s
  double beta = 0, gamma = 0;
  int modes = 0;
  bool operator==(const StreamHeader&) const = default;
};

/// One packet. Of kind `acceleration` only `a` is there; `keyframe` has the whole state at the end of its step (at step
/// 0 the initial one), `end` nothing: its step is the number of steps of the stream.
struct StreamPacket {
  enum class Kind : std::uint8_t { keyframe = 1, acceleration = 2, end = 3 };
  StreamHeader header;
  Kind kind = Kind::acceleration;
  std::uint32_t step = 0;
  Vector q, v, a;  ///< kg^(1/2) m and per s, s^2
};

/// The bytes of a packet (docs/reference/acceleration_stream.md): magic, length, CRC-32, content. Throws
/// std::invalid_argument where sizes do not fit.
std::string encode_packet(const StreamPacket& packet);

/// Largest number of bytes that a packet may have; one fits a UDP datagram up to 2700 modes.
inline constexpr std::size_t largest_packet = 65000;

/// Finds packets in bytes that may have been cut, damaged or mixed with others: what fails its CRC-32, or says of
/// itself what cannot be, is skipped up to the next magic.
class PacketReader {
 public:
  /// Appends bytes as they arrive.
  void add(std::string_view bytes);
  /// No more bytes follow: what is left of the last packet is damage.
  void finish() { finished_ = true; }
  /// For datagrams: what is left of the one before belongs to no packet.
  void restart();
  /// The next packet, or nothing until more bytes are there.
  std::optional<StreamPacket> next();
  /// Bytes that belonged to no packet, so far.
  std::uint64_t skipped() const { return skipped_; }

 private:
  void skip(std::size_t count);

  std::string buffer_;
  std::size_t begin_ = 0;
  std::uint64_t skipped_ = 0;
  bool finished_ = false;
};

}  // namespace taut
