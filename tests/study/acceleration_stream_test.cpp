#include "study/acceleration_stream.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/random_values.h"

namespace taut {
namespace {

std::string stream_of(int steps, double h = 0.01) {
  RandomValues random(9);
  StreamPacket packet;
  packet.header = {7, h, 0.25, 0.5, 3};
  packet.kind = StreamPacket::Kind::keyframe;
  packet.q = random.vector(3);
  packet.v = random.vector(3);
  packet.a = random.vector(3);
  std::string bytes = encode_packet(packet);
  for (int step = 1; step <= steps; ++step) {
    packet.kind = StreamPacket::Kind::acceleration;
    packet.step = static_cast<std::uint32_t>(step);
    packet.a = random.vector(3);
    bytes += encode_packet(packet);
  }
  packet.kind = StreamPacket::Kind::end;
  return bytes + encode_packet(packet);
}

ReceivedStream through(const ReceivedStream& original, const Channel& channel) {
  return received_stream(sent(original, channel), 0);
}

TEST(AccelerationStream, ReorderedDuplicatedAndForeignPacketsChangeNothing) {
  const ReceivedStream original = read_stream(stream_of(40));
  std::vector<StreamPacket> packets = sent(original, {});
  const std::vector<StreamPacket> strangers = sent(read_stream(stream_of(5, 0.02)), {});
  packets.insert(packets.end(), packets.begin(), packets.begin() + 20);
  packets.insert(packets.end(), strangers.begin(), strangers.end());
  std::shuffle(packets.begin(), packets.end(), std::mt19937(3));
  const ReceivedStream received = received_stream(packets, 0);
  EXPECT_EQ(received.duplicates, 20);
  EXPECT_EQ(received.foreign, 7);
  const RebuiltStream truth = rebuild(original, Fill::zero), found = rebuild(received, Fill::zero);
  EXPECT_TRUE(found.lost.empty());
  ASSERT_EQ(found.states.size(), 41);
  EXPECT_EQ(found.states.back().q, truth.states.back().q);
}

TEST(AccelerationStream, TheSameSeedLosesTheSameAndTheRateIsAboutTheOneAskedFor) {
  const ReceivedStream original = read_stream(stream_of(5000));
  Channel channel;
  channel.loss = 0.1;
  const auto one = rebuild(through(original, channel), Fill::hold).lost;
  EXPECT_EQ(one, rebuild(through(original, channel), Fill::hold).lost);
  EXPECT_NEAR(static_cast<double>(one.size()), 500, 5 * std::sqrt(450));
  channel.seed = 2;
  EXPECT_NE(one, rebuild(through(original, channel), Fill::hold).lost);
}

TEST(AccelerationStream, DropsAreTheOnesListedAndKeyframesEndDistortion) {
  const ReceivedStream original = read_stream(stream_of(100));
  Channel channel;
  channel.drop = {13, 14, 47};
  channel.keyframe = 20;
  const RebuiltStream rebuilt = rebuild(through(original, channel), Fill::zero);
  EXPECT_EQ(rebuilt.lost, channel.drop);
  for (const Distortion& d : distortions(rebuild(original, Fill::zero), rebuilt)) {
    const bool distorted = (d.step >= 13 && d.step < 20) || (d.step >= 47 && d.step < 60);
    EXPECT_EQ(d.displacement > 0, distorted) << d.step;
    EXPECT_EQ(d.lost, d.step == 13 || d.step == 14 || d.step == 47) << d.step;
  }
}

TEST(AccelerationStream, WithoutAKeyframeThereIsNothingToBeginFrom) {
  ReceivedStream stream = read_stream(stream_of(3));
  stream.keyframes.clear();
  EXPECT_THROW(rebuild(stream, Fill::zero), std::runtime_error);
}

TEST(AccelerationStream, TablesHaveALineAStep) {
  const ReceivedStream original = read_stream(stream_of(3));
  Channel channel;
  channel.drop = {2};
  const std::string csv =
      distortion_csv(distortions(rebuild(original, Fill::zero), rebuild(through(original, channel), Fill::zero)));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 5);
  EXPECT_TRUE(csv.starts_with("step,time,lost,displacement,velocity\n0,0,0,0,0\n1,0.01,0,0,0\n2,0.02,1,"));
}

}  // namespace
}  // namespace taut
