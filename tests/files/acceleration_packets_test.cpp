#include "files/acceleration_packets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/random_values.h"

namespace taut {
namespace {

StreamHeader header() { return {42, 0.01, 0.25, 0.5, 3}; }

StreamPacket packet(std::uint32_t step) {
  StreamPacket p;
  p.header = header();
  p.step = step;
  p.a = RandomValues(step + 1).vector(3);
  return p;
}

StreamPacket keyframe() {
  StreamPacket p = packet(0);
  p.kind = StreamPacket::Kind::keyframe;
  p.q = Vector::Ones(3);
  p.v = Vector::Zero(3);
  return p;
}

std::vector<StreamPacket> all_of(std::string_view bytes, std::uint64_t* skipped = nullptr) {
  PacketReader reader;
  reader.add(bytes);
  reader.finish();
  std::vector<StreamPacket> packets;
  while (auto p = reader.next()) packets.push_back(*p);
  if (skipped) *skipped = reader.skipped();
  return packets;
}

/// True where each is, bit by bit, one that was sent.
bool only_true_ones(const std::vector<StreamPacket>& packets) {
  return std::all_of(packets.begin(), packets.end(), [](const StreamPacket& p) {
    return p.header == header() && p.kind == StreamPacket::Kind::acceleration && p.a == packet(p.step).a;
  });
}

TEST(AccelerationPackets, ComeBackWithEveryBit) {
  const auto found = all_of(encode_packet(keyframe()) + encode_packet(packet(1)));
  ASSERT_EQ(found.size(), 2);
  EXPECT_EQ(found[0].kind, StreamPacket::Kind::keyframe);
  EXPECT_EQ(found[0].q, Vector::Ones(3));
  EXPECT_EQ(found[0].a, keyframe().a);
  EXPECT_EQ(found[1].header, header());
  EXPECT_EQ(found[1].step, 1);
  EXPECT_EQ(found[1].a, packet(1).a);
}

TEST(AccelerationPackets, ComeOutOneByOneAsBytesArrive) {
  PacketReader reader;
  const std::string bytes = encode_packet(packet(1)) + encode_packet(packet(2));
  std::vector<std::uint32_t> steps;
  for (const char byte : bytes) {
    reader.add({&byte, 1});
    while (auto p = reader.next()) steps.push_back(p->step);
  }
  EXPECT_EQ(steps, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(reader.skipped(), 0);
}

TEST(AccelerationPackets, ACutPacketCostsOnlyItself) {
  const std::string one = encode_packet(packet(1)), two = encode_packet(packet(2));
  for (std::size_t length = 0; length < one.size(); ++length) {
    std::uint64_t skipped = 0;
    const auto found = all_of(one.substr(0, length) + two, &skipped);
    ASSERT_EQ(found.size(), 1) << length;
    EXPECT_EQ(found[0].step, 2);
    EXPECT_EQ(skipped, length);
    EXPECT_EQ(all_of(two + one.substr(0, length)).size(), 1) << length;
  }
}

TEST(AccelerationPackets, NoFlippedBitMakesAWrongPacket) {
  const std::string good = encode_packet(packet(1)) + encode_packet(packet(2)) + encode_packet(packet(3));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    const auto found = all_of(bad);
    EXPECT_EQ(found.size(), 2) << bit;
    EXPECT_TRUE(only_true_ones(found)) << bit;
  }
}

TEST(AccelerationPackets, RandomDamageNeitherCrashesNorInventsAPacket) {
  std::mt19937 random(5);
  std::string good;
  for (std::uint32_t step = 1; step <= 20; ++step) good += encode_packet(packet(step));
  for (int trial = 0; trial < 3000; ++trial) {
    std::string bad = good;
    for (int k = 0; k < 6; ++k) {
      const std::size_t at = random() % bad.size(), count = std::min<std::size_t>(random() % 60, bad.size() - at);
      const auto kind = random() % 3;
      if (kind == 0) bad.erase(at, count);
      if (kind == 1) bad.insert(at, bad.substr(random() % bad.size(), count));
      if (kind == 2) bad[at] = static_cast<char>(random());
      if (bad.empty()) bad = "x";
    }
    EXPECT_TRUE(only_true_ones(all_of(bad))) << trial;
  }
  std::string noise(100000, '\0');
  for (char& c : noise) c = static_cast<char>(random());
  EXPECT_TRUE(all_of(noise).empty());
}

TEST(AccelerationPackets, ALengthBeyondReasonIsRefused) {
  std::string bytes = encode_packet(packet(1));
  bytes[8] = bytes[9] = bytes[10] = bytes[11] = '\xff';
  EXPECT_TRUE(all_of(bytes).empty());
  StreamPacket large = packet(1);
  large.header.modes = 100000;
  large.a = Vector::Zero(100000);
  EXPECT_THROW(encode_packet(large), std::invalid_argument);
}

TEST(AccelerationPackets, RefuseVectorsOfAnotherSize) {
  StreamPacket wrong = packet(1);
  wrong.a = Vector::Zero(2);
  EXPECT_THROW(encode_packet(wrong), std::invalid_argument);
}

}  // namespace
}  // namespace taut
