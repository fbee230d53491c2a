#include <fcntl.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "cli/commands.h"
#include "files/atomic_file.h"
#include "files/datagrams.h"
#include "files/descriptor.h"
#include "study/acceleration_stream.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

struct ReplayArguments {
  std::string source, original, out, send, fill = "zero";
  Channel channel;
  double patience = 5;
  bool quiet = false;
};

const std::map<std::string, Fill> fills{{"zero", Fill::zero}, {"hold", Fill::hold}, {"linear", Fill::linear}};

/// The port of udp:PORT, or nothing for another name.
std::optional<int> udp_port(const std::string& name) {
  if (!name.starts_with("udp:")) return {};
  const std::string digits = name.substr(4);
  const bool number = !digits.empty() && digits.size() <= 5 && digits.find_first_not_of("0123456789") == digits.npos;
  const int port = number ? std::stoi(digits) : -1;
  if (port < 0 || port > 65535) throw UsageError(name + ": expected udp:PORT, PORT from 0 to 65535");
  return port;
}

/// Datagrams until the stream ends or none comes for a while.
ReceivedStream receive(int port, double patience) {
  DatagramReceiver receiver(port);
  fmt::print(stderr, "listening on udp:{}\n", receiver.port());
  const auto wait = std::chrono::milliseconds(static_cast<long>(1000 * patience));
  // A packet that was overtaken by the end has a moment to come.
  constexpr std::chrono::milliseconds moment{200};
  PacketReader reader;
  std::vector<StreamPacket> packets;
  bool ended = false;
  while (const auto datagram = receiver.receive(ended ? moment : wait)) {
    reader.restart();
    reader.add(*datagram);
    while (auto packet = reader.next()) {
      ended = ended || packet->kind == StreamPacket::Kind::end;
      packets.push_back(std::move(*packet));
    }
  }
  reader.restart();
  return received_stream(packets, reader.skipped());
}

ReceivedStream read_standard_input() {
  std::string bytes, part(1 << 16, '\0');
  for (std::size_t size = 1; size > 0;) {
    size = std::fread(part.data(), 1, part.size(), stdin);
    bytes.append(part, 0, size);
  }
  return read_stream(bytes);
}

ReceivedStream read_source(const std::string& source, double patience) {
  ReceivedStream stream;
  if (const auto port = udp_port(source)) {
    stream = receive(*port, patience);
  } else if (source == "-") {
    stream = read_standard_input();
  } else {
    try {
      stream = read_stream(read_bytes(source));
    } catch (const FileError& error) {
      throw UsageError(error.what());
    }
  }
  if (stream.keyframes.empty())
    throw UsageError(source + ": no stream of accelerations that can be rebuilt: no keyframe arrived");
  return stream;
}

/// What the stream is compared with: --against, or the source before the channel, or nothing.
std::optional<RebuiltStream> original_of(const ReplayArguments& arguments, const ReceivedStream& source) {
  if (arguments.original.empty())
    return arguments.channel.changes() ? std::optional(rebuild(source, Fill::zero)) : std::nullopt;
  const ReceivedStream original = read_source(arguments.original, arguments.patience);
  if (original.header.modes != source.header.modes) {
    throw UsageError(fmt::format("{}: found {} modes, allowed: the {} of {}", arguments.original, original.header.modes,
                                 source.header.modes, arguments.source));
  }
  return rebuild(original, Fill::zero);
}

void send(const std::vector<StreamPacket>& packets, const std::string& target) {
  if (const auto port = udp_port(target)) {
    DatagramSender sender(*port);
    for (const StreamPacket& packet : packets) {
      sender.send(encode_packet(packet));
      std::this_thread::sleep_for(std::chrono::microseconds(50));  // leaves the receiver time to empty its buffer
    }
    return;
  }
  std::string bytes;
  for (const StreamPacket& packet : packets) bytes += encode_packet(packet);
  if (target != "-") return write_atomically(target, bytes);
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || std::fflush(stdout) != 0)
    throw std::runtime_error("cannot write to standard output");
}

void report(const ReceivedStream& stream, const RebuiltStream& rebuilt, const std::vector<Distortion>& distortions) {
  fmt::print("{} modes, h = {} s, beta = {}, gamma = {}\n", stream.header.modes, stream.header.step, stream.header.beta,
             stream.header.gamma);
  fmt::print("{} of {} accelerations lost, {} keyframes, {} duplicates, {} foreign packets, {} bytes skipped{}\n",
             rebuilt.lost.size(), stream.steps - rebuilt.first_step, stream.keyframes.size(), stream.duplicates,
             stream.foreign, stream.skipped_bytes, stream.ended ? "" : ", no end packet");
  if (distortions.empty()) return;
  double largest = 0, velocity = 0;
  for (const Distortion& d : distortions) {
    largest = std::max(largest, d.displacement);
    velocity = std::max(velocity, d.velocity);
  }
  fmt::print("distortion: largest |dq| {:.6g} kg^(1/2) m, |dv| {:.6g} kg^(1/2) m/s, at the end |dq| {:.6g}\n", largest,
             velocity, distortions.back().displacement);
}

int replay(const ReplayArguments& arguments) {
  const ReceivedStream source = read_source(arguments.source, arguments.patience);
  const std::vector<StreamPacket> packets = sent(source, arguments.channel);
  if (!arguments.send.empty()) {
    send(packets, arguments.send);
    return exit_solved;
  }
  const ReceivedStream stream = arguments.channel.changes() ? received_stream(packets, source.skipped_bytes) : source;
  const RebuiltStream rebuilt = rebuild(stream, fills.at(arguments.fill));
  const std::optional<RebuiltStream> original = original_of(arguments, source);
  const std::vector<Distortion> distorted = original ? distortions(*original, rebuilt) : std::vector<Distortion>();
  if (!arguments.out.empty()) {
    const fs::path out = arguments.out;
    std::error_code error;
    fs::create_directories(out, error);
    if (error) throw UsageError(arguments.out + ": cannot be created: " + error.message());
    write_atomically(out / "trajectory.csv", trajectory_csv(rebuilt));
    if (original) {
      write_atomically(out / "distortion.csv", distortion_csv(distorted));
      write_distortion_chart(out / "distortion.svg", distorted,
                             fmt::format("Distortion, {} of {} lost, fill {}", rebuilt.lost.size(),
                                         stream.steps - rebuilt.first_step, arguments.fill));
    }
  }
  if (!arguments.quiet) report(stream, rebuilt, distorted);
  return exit_solved;
}

constexpr const char* footer =
    "\nSOURCE and the target of --send: a file, - (standard input and output) or udp:PORT on this machine. Packets "
    "may\n"
    "come in any order, twice, cut or damaged; what fails its CRC-32 is skipped. A receiver on udp waits for the end\n"
    "packet, or until nothing has come for --patience seconds; port 0 takes a free one and says which.\n"
    "\n"
    "Files in DIR: trajectory.csv (q of every step), and where there is an original to compare with (--against, or "
    "the\n"
    "source before --loss, --drop and --keyframe) distortion.csv and distortion.svg.\n"
    "\n"
    "Exit codes: 0 rebuilt or sent, 1 internal error, 2 wrong usage, or a source without a keyframe to begin from.\n"
    "\n"
    "Examples:\n"
    "  taut solve modal_cantilever --record-accelerations run.acc\n"
    "  taut replay run.acc --loss 0.05 --fill hold --out out/replay\n"
    "  taut replay run.acc --drop 20,21,22 --keyframe 50 --out out/burst\n"
    "  taut replay udp:5000 --against run.acc --out out/received     and in another terminal\n"
    "  taut replay run.acc --loss 0.1 --send udp:5000";

}  // namespace

void add_replay(CLI::App& program, int& code) {
  CLI::App* command = program.add_subcommand("replay", "Rebuild a trajectory from recorded accelerations, some lost");
  command->footer(footer);
  const auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("SOURCE", arguments->source, "The stream: a file, - or udp:PORT")->required();
  const auto loss = command->add_option("--loss", arguments->channel.loss, "Probability that an acceleration is lost")
                        ->type_name("RATE")
                        ->check(CLI::Range(0.0, 1.0));
  command->add_option("--drop", arguments->channel.drop, "Steps whose accelerations are lost, separated by commas")
      ->type_name("LIST")
      ->delimiter(',')
      ->excludes(loss);
  command->add_option("--fill", arguments->fill, "What stands in for a lost one: zero, hold or linear")
      ->type_name("FILL")
      ->check(CLI::IsMember({"zero", "hold", "linear"}));
  command->add_option("--keyframe", arguments->channel.keyframe, "Send the whole state every so many steps")
      ->type_name("K")
      ->check(CLI::Range(0, 1000000000));
  command->add_option("--seed", arguments->channel.seed, "Of --loss; the same seed loses the same")->type_name("S");
  command->add_option("--against", arguments->original, "The stream that nothing was lost of, to compare with")
      ->type_name("FILE");
  command->add_option("--send", arguments->send, "Send the packets on instead of rebuilding")->type_name("TARGET");
  command->add_option("--patience", arguments->patience, "Seconds without a datagram after which a receiver ends")
      ->type_name("S")
      ->check(CLI::Range(0.001, 3600.0));
  command->add_option("--out", arguments->out, "Write results to this directory")->type_name("DIR");
  command->add_flag("--quiet", arguments->quiet, "Print nothing");
  command->callback([arguments, &code] { code = replay(*arguments); });
}

}  // namespace taut
