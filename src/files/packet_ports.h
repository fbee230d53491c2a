#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "files/acceleration_packets.h"
#include "files/datagrams.h"
#include "files/descriptor.h"

namespace taut {

/// Packets as they arrive at a port: a file or a named pipe, - for standard input, or udp:PORT on this machine.
class PacketSource {
 public:
  /// `patience`: after how long without a datagram the source has ended. Throws FileError, which names the port, where
  /// it cannot be opened.
  PacketSource(const std::string& port, std::chrono::milliseconds patience);

  /// Waits for the next packet; nothing where the source has ended. After the end packet of its stream (`ended`)
  /// datagrams that it overtook have a moment left.
  std::optional<StreamPacket> next(bool ended);
  /// Bytes that belonged to no packet, so far.
  std::uint64_t skipped() const { return reader_.skipped(); }
  /// Of a UDP port, which the system chooses where 0 was asked for.
  std::optional<int> udp_port() const;

 private:
  bool take_datagram(std::chrono::milliseconds patience);
  bool take_bytes();

  std::chrono::milliseconds patience_;
  std::unique_ptr<DatagramReceiver> socket_;
  std::unique_ptr<Descriptor> file_;
  PacketReader reader_;
};

/// Puts packets out of such a port, each at once; - is standard output.
class PacketTarget {
 public:
  /// Throws FileError, which names the port, where it cannot be opened.
  explicit PacketTarget(const std::string& port);
  /// Throws FileError where it cannot be written. A datagram that nobody receives is lost without an error.
  void put(const StreamPacket& packet);

 private:
  std::unique_ptr<DatagramSender> socket_;
  std::unique_ptr<Descriptor> file_;
};

}  // namespace taut
