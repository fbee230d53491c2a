#include "files/datagrams.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "files/file_error.h"

namespace taut {
namespace {

[[noreturn]] void fail(int port, const std::string& action) {
  throw FileError("udp:" + std::to_string(port), action + ": " + std::generic_category().message(errno));
}

sockaddr_in loopback(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return address;
}

int datagram_socket(int port) {
  const int descriptor = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) fail(port, "cannot open a UDP socket");
  return descriptor;
}

}  // namespace

DatagramSender::DatagramSender(int port) : socket_(datagram_socket(port)), port_(port) {
  const sockaddr_in address = loopback(port);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return;
  const int reason = errno;
  ::close(socket_);
  errno = reason;
  fail(port, "cannot send to this port");
}

DatagramSender::~DatagramSender() { ::close(socket_); }

void DatagramSender::send(std::string_view bytes) {
  if (::send(socket_, bytes.data(), bytes.size(), 0) >= 0) return;
  // The refusal of an earlier datagram, which this one was told of: it is lost, as datagrams may be.
  if (errno != ECONNREFUSED) fail(port_, "cannot send a datagram");
}

DatagramReceiver::DatagramReceiver(int port) : socket_(datagram_socket(port)), port_(port) {
  sockaddr_in address = loopback(port);
  socklen_t size = sizeof address;
  const int room = 4 << 20;  // for bursts; where the system allows less, less
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room);
  const bool bound = ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0 &&
                     ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) == 0;
  if (bound) {
    port_ = ntohs(address.sin_port);
    return;
  }
  const int reason = errno;
  ::close(socket_);
  errno = reason;
  fail(port, "cannot receive on this port");
}

DatagramReceiver::~DatagramReceiver() { ::close(socket_); }

std::optional<std::string> DatagramReceiver::receive(std::chrono::milliseconds patience) {
  pollfd waiting{socket_, POLLIN, 0};
  const int ready = ::poll(&waiting, 1, static_cast<int>(patience.count()));
  if (ready < 0 && errno != EINTR) fail(port_, "cannot wait for a datagram");
  if (ready <= 0) return {};
  std::string bytes(1 << 16, '\0');
  const ssize_t size = ::recv(socket_, bytes.data(), bytes.size(), 0);
  if (size < 0) fail(port_, "cannot receive a datagram");
  bytes.resize(static_cast<std::size_t>(size));
  return bytes;
}

}  // namespace taut
