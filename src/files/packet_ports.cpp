#include "files/packet_ports.h"

#include <fcntl.h>
#include <unistd.h>

#include <thread>

#include "files/file_error.h"

namespace taut {
namespace {

/// The number of udp:PORT, or nothing for the name of a file.
std::optional<int> number_of(const std::string& port) {
  if (!port.starts_with("udp:")) return {};
  const std::string digits = port.substr(4);
  const bool number = !digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == digits.npos;
  const int value = number ? std::stoi(digits) : -1;
  if (value < 0 || value > 65535) throw FileError(port, "expected udp:PORT, PORT from 0 to 65535");
  return value;
}

}  // namespace

PacketSource::PacketSource(const std::string& port, std::chrono::milliseconds patience) : patience_(patience) {
  if (const auto number = number_of(port)) {
    socket_ = std::make_unique<DatagramReceiver>(*number);
    return;
  }
  std::error_code error;
  if (std::filesystem::is_directory(port, error)) throw FileError(port, "is a directory");
  file_ = port == "-" ? std::make_unique<Descriptor>(STDIN_FILENO, "standard input")
                      : std::make_unique<Descriptor>(port, O_RDONLY);
}

std::optional<int> PacketSource::udp_port() const { return socket_ ? std::optional(socket_->port()) : std::nullopt; }

std::optional<StreamPacket> PacketSource::next(bool ended) {
  constexpr std::chrono::milliseconds moment{200};
  for (;;) {
    if (auto packet = reader_.next()) return packet;
    if (!(socket_ ? take_datagram(ended ? moment : patience_) : take_bytes())) return reader_.next();
  }
}

bool PacketSource::take_datagram(std::chrono::milliseconds patience) {
  const auto datagram = socket_->receive(patience);
  reader_.restart();
  if (datagram) reader_.add(*datagram);
  return datagram.has_value();
}

bool PacketSource::take_bytes() {
  std::string bytes(1 << 16, '\0');
  bytes.resize(file_->read(bytes.data(), bytes.size()));
  reader_.add(bytes);
  if (bytes.empty()) reader_.finish();
  return !bytes.empty();
}

PacketTarget::PacketTarget(const std::string& port) {
  if (const auto number = number_of(port)) {
    socket_ = std::make_unique<DatagramSender>(*number);
  } else {
    file_ = port == "-" ? std::make_unique<Descriptor>(STDOUT_FILENO, "standard output")
                        : std::make_unique<Descriptor>(port, O_WRONLY | O_CREAT | O_TRUNC);
  }
}

void PacketTarget::put(const StreamPacket& packet) {
  if (file_) return file_->write(encode_packet(packet));
  socket_->send(encode_packet(packet));
  std::this_thread::sleep_for(std::chrono::microseconds(50));  // leaves the receiver time to empty its buffer
}

}  // namespace taut
