#include "files/acceleration_packets.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <stdexcept>

namespace taut {
namespace {

static_assert(std::endian::native == std::endian::little, "packets are little-endian");

constexpr std::string_view magic = "TAUTACC1";
constexpr std::size_t frame_size = magic.size() + 2 * sizeof(std::uint32_t);  // magic, length and CRC of the content
constexpr std::size_t fixed_content = sizeof(std::uint64_t) + 3 * sizeof(double) + 3 * sizeof(std::uint32_t);

std::uint32_t checksum(std::string_view content) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size()));
}

template <typename Number>
void put(std::string& bytes, Number number) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

template <typename Number>
Number take(std::string_view& bytes) {
  Number number;
  std::memcpy(&number, bytes.data(), sizeof number);
  bytes.remove_prefix(sizeof number);
  return number;
}

int vectors_of(StreamPacket::Kind kind) {
  switch (kind) {
    case StreamPacket::Kind::keyframe:
      return 3;
    case StreamPacket::Kind::acceleration:
      return 1;
    case StreamPacket::Kind::end:
      break;
  }
  return 0;
}

void put_vector(std::string& bytes, const Vector& vector, int modes) {
  if (vector.size() != modes) {
    throw std::invalid_argument("encode_packet: a vector has " + std::to_string(vector.size()) + " entries, expected " +
                                std::to_string(modes));
  }
  bytes.append(reinterpret_cast<const char*>(vector.data()), static_cast<std::size_t>(modes) * sizeof(double));
}

Vector take_vector(std::string_view& bytes, int modes) {
  Vector vector(modes);
  if (modes > 0) std::memcpy(vector.data(), bytes.data(), static_cast<std::size_t>(modes) * sizeof(double));
  bytes.remove_prefix(static_cast<std::size_t>(modes) * sizeof(double));
  return vector;
}

/// Nothing where the content, though its CRC is right, cannot be a packet.
std::optional<StreamPacket> decode(std::string_view content) {
  StreamPacket packet;
  packet.header.stream = take<std::uint64_t>(content);
  packet.header.step = take<double>(content);
  packet.header.beta = take<double>(content);
  packet.header.gamma = take<double>(content);
  const auto modes = take<std::uint32_t>(content);
  packet.step = take<std::uint32_t>(content);
  const auto kind = take<std::uint32_t>(content);
  if (kind < 1 || kind > 3 || modes > largest_packet / sizeof(double)) return {};
  packet.kind = static_cast<StreamPacket::Kind>(kind);
  packet.header.modes = static_cast<int>(modes);
  const bool sane = packet.header.step > 0 && std::isfinite(packet.header.step) && std::isfinite(packet.header.beta) &&
                    std::isfinite(packet.header.gamma);
  if (!sane || content.size() != static_cast<std::size_t>(vectors_of(packet.kind)) * modes * sizeof(double)) return {};
  if (packet.kind == StreamPacket::Kind::keyframe) {
    packet.q = take_vector(content, packet.header.modes);
    packet.v = take_vector(content, packet.header.modes);
  }
  if (packet.kind != StreamPacket::Kind::end) packet.a = take_vector(content, packet.header.modes);
  return packet;
}

}  // namespace

std::string encode_packet(const StreamPacket& packet) {
  std::string content;
  put(content, packet.header.stream);
  put(content, packet.header.step);
  put(content, packet.header.beta);
  put(content, packet.header.gamma);
  put(content, static_cast<std::uint32_t>(packet.header.modes));
  put(content, packet.step);
  put(content, static_cast<std::uint32_t>(packet.kind));
  if (packet.kind == StreamPacket::Kind::keyframe) {
    put_vector(content, packet.q, packet.header.modes);
    put_vector(content, packet.v, packet.header.modes);
  }
  if (packet.kind != StreamPacket::Kind::end) put_vector(content, packet.a, packet.header.modes);
  if (frame_size + content.size() > largest_packet) {
    throw std::invalid_argument("encode_packet: " + std::to_string(packet.header.modes) + " modes make a packet of " +
                                std::to_string(frame_size + content.size()) + " bytes, more than " +
                                std::to_string(largest_packet));
  }
  std::string bytes(magic);
  put(bytes, static_cast<std::uint32_t>(content.size()));
  put(bytes, checksum(content));
  return bytes += content;
}

void PacketReader::add(std::string_view bytes) {
  buffer_.erase(0, begin_);
  begin_ = 0;
  buffer_ += bytes;
}

void PacketReader::restart() {
  skipped_ += buffer_.size() - begin_;
  buffer_.clear();
  begin_ = 0;
}

void PacketReader::skip(std::size_t count) {
  begin_ += count;
  skipped_ += count;
}

std::optional<StreamPacket> PacketReader::next() {
  while (true) {
    const std::string_view rest = std::string_view(buffer_).substr(begin_);
    const std::size_t at = rest.find(magic);
    if (at == rest.npos) {
      // A magic may have begun in the last bytes.
      const std::size_t kept = finished_ ? 0 : std::min(rest.size(), magic.size() - 1);
      skip(rest.size() - kept);
      return {};
    }
    skip(at);
    std::string_view frame = rest.substr(at);
    if (frame.size() < frame_size) {
      if (finished_) skip(frame.size());
      return {};
    }
    frame.remove_prefix(magic.size());
    const auto length = take<std::uint32_t>(frame);
    const auto crc = take<std::uint32_t>(frame);
    if (length < fixed_content || length > largest_packet - frame_size) {
      skip(magic.size());
      continue;
    }
    if (frame.size() < length) {
      if (!finished_) return {};
      skip(magic.size());
      continue;
    }
    const std::string_view content = frame.substr(0, length);
    std::optional<StreamPacket> packet;
    if (checksum(content) == crc) packet = decode(content);
    if (!packet) {
      skip(magic.size());
      continue;
    }
    begin_ += frame_size + length;
    return packet;
  }
}

}  // namespace taut
