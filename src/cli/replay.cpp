#include <fcntl.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "cli/arguments.h"
#include "cli/commands.h"
#include "files/atomic_file.h"
#include "files/descriptor.h"
#include "files/packet_ports.h"
#include "study/acceleration_stream.h"

namespace taut {
namespace fs = std::filesystem;
namespace {

struct ReplayArguments {
  std::string source, original, out, send, fill = "zero";
  Channel channel;
  int window = 64;
  double patience = 5;
  bool quiet = false;
};

const std::map<std::string, Fill> fills{{"zero", Fill::zero}, {"hold", Fill::hold}, {"linear", Fill::linear}};

[[noreturn]] void refuse_without_keyframe(const std::string& source) {
  throw UsageError(source + ": no stream of accelerations that can be rebuilt: no keyframe arrived");
}

/// What frames are compared with, by step.
using Original = std::map<int, SpectralState>;

Original read_original(const std::string& file) {
  const RebuiltStream stream = read_stream(read_bytes(file));
  if (stream.frames.empty()) refuse_without_keyframe(file);
  Original original;
  for (const StreamFrame& frame : stream.frames) original.emplace(frame.step, frame.state);
  return original;
}

/// Writes frames as they become certain, and how far they are from the original.
class FrameWriter {
 public:
  FrameWriter(const ReplayArguments& arguments, bool compared) : arguments_(arguments) {
    if (!arguments_.original.empty()) original_ = read_original(arguments_.original);
    if (arguments_.out.empty()) return;
    make_folder(arguments_.out);
    trajectory_ = open("trajectory.csv");
    if (compared) table_ = open("distortion.csv");
  }

  /// What the frame of this step will be compared with.
  void compare_with(int step, const SpectralState& state) { original_.emplace(step, state); }

  void write(const StreamHeader& header, const StreamFrame& frame) {
    if (!begun_) begin(header);
    if (trajectory_) trajectory_->write(trajectory_line(frame, header.step));
    const auto truth = original_.find(frame.step);
    if (truth == original_.end()) return;
    distortions_.push_back(distortion(frame, truth->second, header.step));
    original_.erase(original_.begin(), std::next(truth));
    if (table_) table_->write(distortion_line(distortions_.back()));
  }

  void finish(const StreamReceiver& receiver, std::uint64_t skipped) const {
    const auto& counts = receiver.counts();
    const int accelerations = counts.frames - 1;
    if (table_) {
      write_distortion_chart(
          fs::path(arguments_.out) / "distortion.svg", distortions_,
          fmt::format("Distortion, {} of {} lost, fill {}", counts.lost, accelerations, arguments_.fill));
    }
    if (arguments_.quiet) return;
    const StreamHeader& header = *receiver.header();
    fmt::print("{} modes, h = {} s, beta = {}, gamma = {}\n", header.modes, header.step, header.beta, header.gamma);
    fmt::print(
        "{} of {} accelerations lost, {} keyframes, {} duplicates, {} late, {} foreign packets, {} bytes skipped{}\n",
        counts.lost, accelerations, counts.keyframes, counts.duplicates, counts.late, counts.foreign, skipped,
        receiver.ended() ? "" : ", no end packet");
    if (distortions_.empty()) return;
    double largest = 0, velocity = 0;
    for (const Distortion& d : distortions_) {
      largest = std::max(largest, d.displacement);
      velocity = std::max(velocity, d.velocity);
    }
    fmt::print("distortion: largest |dq| {:.6g} kg^(1/2) m, |dv| {:.6g} kg^(1/2) m/s, at the end |dq| {:.6g}\n",
               largest, velocity, distortions_.back().displacement);
  }

 private:
  std::unique_ptr<Descriptor> open(const char* name) const {
    return std::make_unique<Descriptor>(fs::path(arguments_.out) / name, O_WRONLY | O_CREAT | O_TRUNC);
  }
  void begin(const StreamHeader& header) {
    begun_ = true;
    const Index modes = original_.empty() ? header.modes : original_.begin()->second.q.size();
    if (modes != header.modes) {
      throw UsageError(fmt::format("{}: found {} modes, allowed: the {} of {}", arguments_.original, modes,
                                   header.modes, arguments_.source));
    }
    if (trajectory_) trajectory_->write(trajectory_header(header.modes));
    if (table_) table_->write(distortion_header());
  }

  const ReplayArguments& arguments_;
  bool begun_ = false;
  Original original_;
  std::unique_ptr<Descriptor> trajectory_, table_;
  std::vector<Distortion> distortions_;
};

/// Opens what can be named wrongly: that is bad input, whereas a disk that is full later is not.
template <typename T, typename... Arguments>
T opened(Arguments&&... arguments) try {
  return T(std::forward<Arguments>(arguments)...);
} catch (const FileError& error) {
  throw UsageError(error.what());
}

PacketSource open_source(const ReplayArguments& arguments) {
  auto source =
      opened<PacketSource>(arguments.source, std::chrono::milliseconds(static_cast<long>(1000 * arguments.patience)));
  if (const auto port = source.udp_port()) fmt::print(stderr, "listening on udp:{}\n", *port);
  return source;
}

/// Gives the frames of the source to `take` as they become certain.
template <typename Take>
void receive(const ReplayArguments& arguments, PacketSource& source, StreamReceiver& receiver, Take take) {
  for (bool more = true; more && !receiver.complete();) {
    auto packet = source.next(receiver.ended());
    more = packet.has_value();
    if (more) {
      receiver.take(std::move(*packet));
    } else {
      receiver.finish();
    }
    while (auto frame = receiver.next()) take(*frame);
  }
  if (receiver.counts().frames == 0) refuse_without_keyframe(arguments.source);
}

/// Gives the packets of the source to `put` as they leave the channel, and each frame to `see` before that.
template <typename See, typename Put>
void relay(const ReplayArguments& arguments, PacketSource& source, See see, Put put) {
  StreamReceiver receiver(Fill::zero, arguments.window);
  StreamSender sender(arguments.channel);
  int last = 0;
  receive(arguments, source, receiver, [&](const StreamFrame& frame) {
    see(frame);
    for (StreamPacket& packet : sender.packets(*receiver.header(), frame)) put(std::move(packet));
    last = frame.step;
  });
  put(StreamSender::end(*receiver.header(), last));
}

int replay(const ReplayArguments& arguments) {
  PacketSource source = open_source(arguments);
  if (!arguments.send.empty()) {
    std::error_code error;
    if (fs::equivalent(arguments.source, arguments.send, error))
      throw UsageError(arguments.send + ": is the source itself, allowed: another target of --send");
    auto target = opened<PacketTarget>(arguments.send);
    relay(
        arguments, source, [](const StreamFrame&) {}, [&](const StreamPacket& packet) { target.put(packet); });
    return exit_solved;
  }
  const bool lossy = arguments.channel.changes(), against = !arguments.original.empty();
  auto writer = opened<FrameWriter>(arguments, lossy || against);
  StreamReceiver receiver(fills.at(arguments.fill), arguments.window);
  const auto write = [&](const StreamFrame& frame) { writer.write(*receiver.header(), frame); };
  if (lossy) {
    const auto see = [&](const StreamFrame& frame) {
      if (!against) writer.compare_with(frame.step, frame.state);
    };
    relay(arguments, source, see, [&](StreamPacket packet) {
      receiver.take(std::move(packet));
      while (auto frame = receiver.next()) write(*frame);
    });
    receiver.finish();
    while (auto frame = receiver.next()) write(*frame);
  } else {
    receive(arguments, source, receiver, write);
  }
  writer.finish(receiver, source.skipped());
  return exit_solved;
}

constexpr const char* footer =
    "\nSOURCE and the target of --send: a file or named pipe, - (standard input and output) or udp:PORT on this\n"
    "machine. Packets may come in any order, twice, cut or damaged; what fails its CRC-32 is skipped. A frame is "
    "written\n"
    "as soon as it is certain: its packet and all before it are there, or a packet --window steps later is; what is\n"
    "missing by then is lost. A receiver on udp ends with the end packet, or when nothing has come for --patience\n"
    "seconds; port 0 takes a free one and says which.\n"
    "\n"
    "Files in DIR: trajectory.csv (q of every step), and where there is an original to compare with (--against, or "
    "the\n"
    "source before --loss, --drop and --keyframe) distortion.csv and, at the end, distortion.svg.\n"
    "\n"
    "Exit codes: 0 rebuilt or sent, 1 internal error or a file that cannot be written, 2 wrong usage, what cannot be\n"
    "opened, or a source without a keyframe to begin from.\n"
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
  command
      ->add_option("--window", arguments->window,
                   "Steps that a missing packet is waited for, counted by the packets after it")
      ->type_name("STEPS")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--patience", arguments->patience, "Seconds without a datagram after which a receiver ends")
      ->type_name("S")
      ->check(CLI::Range(0.001, 3600.0));
  command->add_option("--out", arguments->out, "Write results to this directory")->type_name("DIR");
  command->add_flag("--quiet", arguments->quiet, "Print nothing");
  command->callback([arguments, &code] { code = replay(*arguments); });
}

}  // namespace taut
