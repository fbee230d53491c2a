#include "study/acceleration_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/random_values.h"

namespace taut {
namespace {

using Kind = StreamPacket::Kind;

/// A keyframe, an acceleration a step, the end.
std::vector<StreamPacket> stream_of(int steps, double h = 0.01) {
  RandomValues random(9);
  const StreamHeader header{7, h, 0.25, 0.5, 3};
  std::vector<StreamPacket> packets{{header, Kind::keyframe, 0, random.vector(3), random.vector(3), random.vector(3)}};
  for (int step = 1; step <= steps; ++step)
    packets.push_back({header, Kind::acceleration, static_cast<std::uint32_t>(step), {}, {}, random.vector(3)});
  packets.push_back(StreamSender::end(header, steps));
  return packets;
}

std::vector<StreamFrame> drained(StreamReceiver& receiver) {
  std::vector<StreamFrame> frames;
  while (auto frame = receiver.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::vector<StreamFrame> received(const std::vector<StreamPacket>& packets, int window,
                                  StreamReceiver::Counts* counts = nullptr) {
  StreamReceiver receiver(Fill::zero, window);
  std::vector<StreamFrame> frames;
  for (const StreamPacket& packet : packets) {
    receiver.take(packet);
    for (StreamFrame& frame : drained(receiver)) frames.push_back(std::move(frame));
  }
  receiver.finish();
  for (StreamFrame& frame : drained(receiver)) frames.push_back(std::move(frame));
  if (counts) *counts = receiver.counts();
  return frames;
}

std::vector<StreamPacket> through(const std::vector<StreamFrame>& frames, const StreamHeader& header,
                                  const Channel& channel) {
  StreamSender sender(channel);
  std::vector<StreamPacket> all;
  for (const StreamFrame& frame : frames) {
    for (StreamPacket& packet : sender.packets(header, frame)) all.push_back(std::move(packet));
  }
  all.push_back(StreamSender::end(header, frames.back().step));
  return all;
}

std::vector<int> lost_steps(const std::vector<StreamFrame>& frames) {
  std::vector<int> steps;
  for (const StreamFrame& frame : frames)
    if (frame.lost) steps.push_back(frame.step);
  return steps;
}

/// Every packet is moved by fewer than `reach` places.
std::vector<StreamPacket> jumbled(std::vector<StreamPacket> packets, int reach, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<std::pair<std::uint64_t, StreamPacket>> places;
  for (std::size_t k = 0; k < packets.size(); ++k) places.emplace_back(k + random() % reach, std::move(packets[k]));
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  packets.clear();
  for (auto& [place, packet] : places) packets.push_back(std::move(packet));
  return packets;
}

TEST(StreamReceiver, GivesEachFrameAsSoonAsItsPacketIsThere) {
  StreamReceiver receiver(Fill::zero, 8);
  int step = 0;
  for (const StreamPacket& packet : stream_of(20)) {
    receiver.take(packet);
    const auto frames = drained(receiver);
    if (packet.kind == Kind::end) {
      EXPECT_TRUE(frames.empty());
      continue;
    }
    ASSERT_EQ(frames.size(), 1);
    EXPECT_EQ(frames[0].step, step++);
  }
  EXPECT_TRUE(receiver.complete());
}

TEST(StreamReceiver, GivesUpAMissingPacketWhenOneAWindowLaterArrivesAndNotBefore) {
  StreamReceiver receiver(Fill::zero, 8);
  for (const StreamPacket& packet : stream_of(20)) {
    if (packet.kind == Kind::acceleration && packet.step == 5) continue;
    receiver.take(packet);
    const auto frames = drained(receiver);
    if (packet.step >= 5 && packet.step < 13) {
      EXPECT_TRUE(frames.empty()) << packet.step;
    }
    if (packet.step == 13) {
      ASSERT_EQ(frames.size(), 9);
      EXPECT_TRUE(frames[0].lost);
      EXPECT_FALSE(frames[1].lost);
    }
  }
}

TEST(StreamReceiver, ReorderingWithinTheWindowDuplicatesAndStrangersChangeNothing) {
  const auto packets = stream_of(400);
  const auto truth = received(packets, 64);
  ASSERT_EQ(truth.size(), 401);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    auto mixed = packets;
    const auto strangers = stream_of(5, 0.02);
    mixed.insert(mixed.begin() + 100, strangers.begin(), strangers.end());
    mixed.insert(mixed.begin() + 60, packets.begin() + 40, packets.begin() + 60);
    mixed = jumbled(std::move(mixed), 30, seed);
    StreamReceiver::Counts counts;
    const auto frames = received(mixed, 64, &counts);
    EXPECT_EQ(counts.duplicates, 20);
    EXPECT_EQ(counts.foreign, 7);
    EXPECT_EQ(counts.lost + counts.late, 0);
    ASSERT_EQ(frames.size(), truth.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      EXPECT_EQ(frames[k].step, truth[k].step);
      EXPECT_EQ(frames[k].state.q, truth[k].state.q);
    }
  }
}

TEST(StreamReceiver, APacketThatComesAfterTheWindowIsLateAndItsFrameStaysLost) {
  auto packets = stream_of(40);
  std::rotate(packets.begin() + 5, packets.begin() + 6, packets.begin() + 30);  // step 5 comes after step 29
  StreamReceiver::Counts counts;
  EXPECT_EQ(lost_steps(received(packets, 8, &counts)), std::vector<int>{5});
  EXPECT_EQ(counts.late, 1);
  EXPECT_TRUE(lost_steps(received(packets, 64, &counts)).empty());
  EXPECT_EQ(counts.late, 0);
}

/// The keyframe of step 20 arrives five steps late: the frames that are out stay as they are, the next is right.
TEST(StreamReceiver, AKeyframeThatComesAfterItsFrameCorrectsTheFramesToCome) {
  const auto packets = stream_of(40);
  const auto truth = received(packets, 64);
  Channel channel;
  channel.drop = {13};
  channel.keyframe = 20;
  auto lossy = through(truth, packets[0].header, channel);
  const auto keyframe =
      std::find_if(lossy.begin() + 1, lossy.end(), [](const auto& p) { return p.kind == Kind::keyframe; });
  std::rotate(keyframe, keyframe + 1, keyframe + 6);
  const auto frames = received(lossy, 8);
  ASSERT_EQ(frames.size(), truth.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const bool distorted = (frames[k].state.q - truth[k].state.q).norm() > 1e-12;
    EXPECT_EQ(distorted, k >= 13 && k <= 24) << k;
  }
}

TEST(StreamReceiver, BeginsWithTheFirstKeyframeThatArrivedAndIgnoresWhatIsBefore) {
  auto packets = stream_of(200);
  const auto truth = received(packets, 16);
  Channel channel;
  channel.keyframe = 50;
  auto joined = through(truth, packets[0].header, channel);
  joined.erase(joined.begin(), joined.begin() + 70);
  const auto frames = received(joined, 16);
  ASSERT_EQ(frames.size(), 101);
  EXPECT_EQ(frames.front().step, 100);
  EXPECT_EQ(frames.back().state.q, truth.back().state.q);
}

TEST(StreamReceiver, WithoutAKeyframeOrAfterAStepThatCannotBeThereIsNoFrame) {
  auto packets = stream_of(30);
  const StreamPacket keyframe = packets.front();
  packets.erase(packets.begin());
  StreamReceiver::Counts counts;
  EXPECT_TRUE(received(packets, 8, &counts).empty());
  packets = {keyframe, packets[0], packets[1]};
  packets[2].step = 4000000000U;
  EXPECT_EQ(received(packets, 8, &counts).size(), 2);
  EXPECT_EQ(counts.foreign, 1);
}

TEST(StreamReceiver, RefusesAWindowOfNothing) { EXPECT_THROW(StreamReceiver(Fill::zero, 0), std::invalid_argument); }

TEST(StreamSender, TheSameSeedLosesTheSameAndTheRateIsAboutTheOneAskedFor) {
  const auto packets = stream_of(5000);
  const auto truth = received(packets, 64);
  Channel channel;
  channel.loss = 0.1;
  const auto lost = [&] { return lost_steps(received(through(truth, packets[0].header, channel), 64)); };
  const auto one = lost();
  EXPECT_EQ(one, lost());
  EXPECT_NEAR(static_cast<double>(one.size()), 500, 5 * std::sqrt(450));
  channel.seed = 2;
  EXPECT_NE(one, lost());
}

TEST(StreamSender, DropsAreTheOnesListedAndKeyframesEndDistortion) {
  const auto packets = stream_of(100);
  const auto truth = received(packets, 64);
  Channel channel;
  channel.drop = {13, 14, 47};
  channel.keyframe = 20;
  const auto frames = received(through(truth, packets[0].header, channel), 64);
  EXPECT_EQ(lost_steps(frames), channel.drop);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Distortion d = distortion(frames[k], truth[k].state, 0.01);
    const bool distorted = (d.step >= 13 && d.step < 20) || (d.step >= 47 && d.step < 60);
    EXPECT_EQ(d.displacement > 0, distorted) << d.step;
  }
}

TEST(StreamSender, RefusesALossThatIsNoProbability) {
  Channel channel;
  channel.loss = 1.5;
  EXPECT_THROW(StreamSender{channel}, std::invalid_argument);
}

TEST(ReadStream, RebuildsWhateverTheOrderIs) {
  auto packets = stream_of(300);
  std::shuffle(packets.begin() + 1, packets.end(), std::mt19937(3));
  std::string bytes;
  for (const StreamPacket& packet : packets) bytes += encode_packet(packet) + "x";
  const RebuiltStream rebuilt = read_stream(bytes);
  EXPECT_EQ(rebuilt.skipped_bytes, packets.size());
  EXPECT_EQ(rebuilt.counts.lost, 0);
  EXPECT_EQ(rebuilt.frames.back().state.q, received(stream_of(300), 64).back().state.q);
}

TEST(AccelerationStream, TablesHaveALineAStep) {
  const StreamFrame frame{2, true, {Vector2(1, 2), Vector2(0, 0), Vector2(0, 0)}};
  EXPECT_EQ(trajectory_header(2) + trajectory_line(frame, 0.5), "step,time,q1,q2\n2,1,1,2\n");
  const SpectralState truth{Vector2(1, 0), Vector2(0, 3), Vector2(0, 0)};
  EXPECT_EQ(distortion_header() + distortion_line(distortion(frame, truth, 0.5)),
            "step,time,lost,displacement,velocity\n2,1,1,2,3\n");
}

}  // namespace
}  // namespace taut
