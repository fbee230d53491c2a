#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

namespace taut {

/// Sends UDP datagrams to a port of this machine (127.0.0.1).
class DatagramSender {
 public:
  /// Throws FileError, which names the port.
  explicit DatagramSender(int port);
  ~DatagramSender();
  DatagramSender(const DatagramSender&) = delete;
  DatagramSender& operator=(const DatagramSender&) = delete;
  /// A datagram that nobody receives is lost without an error. Throws FileError for others.
  void send(std::string_view bytes);

 private:
  int socket_, port_;
};

/// Receives those that come to a port of 127.0.0.1.
class DatagramReceiver {
 public:
  /// Port 0: the system chooses one. Throws FileError where the port is taken.
  explicit DatagramReceiver(int port);
  ~DatagramReceiver();
  DatagramReceiver(const DatagramReceiver&) = delete;
  DatagramReceiver& operator=(const DatagramReceiver&) = delete;

  int port() const { return port_; }
  /// The next datagram, or nothing where none comes in time.
  std::optional<std::string> receive(std::chrono::milliseconds patience);

 private:
  int socket_, port_;
};

}  // namespace taut
