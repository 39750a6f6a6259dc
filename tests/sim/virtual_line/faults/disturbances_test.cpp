#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "sim/virtual_line/faults/echo.hpp"
#include "sim/virtual_line/faults/noise.hpp"
#include "sim/virtual_line/wires/master.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using Heard = std::vector<std::pair<int, ByteStatus>>;

/// A line with a sender and a receiver.
struct TwoOnALine {
  VirtualClock clock;
  Wires wires{clock};
  Heard heard;
  Master sender{wires, hal::SerialMode{9600}, [](std::uint8_t, ByteStatus) {}};
  Master receiver{wires, hal::SerialMode{9600},
                  [this](std::uint8_t byte, ByteStatus status) { heard.emplace_back(byte, status); }};

  void send(const std::vector<std::uint8_t>& bytes) {
    sender.send(bytes.data(), bytes.size());
    wires.run_for(seconds(1));
  }
};

TEST(Noise, ThatLosesEveryCharacterLeavesTheLineIdle) {
  TwoOnALine line;
  NoiseRates rates;
  rates.lost_character = 1;
  Noise noise(line.wires, rates, 1);
  line.send({0x00, 0x55, 0xFF});
  EXPECT_EQ(line.heard, Heard());
  EXPECT_EQ(noise.changes(), 3U);
}

TEST(Noise, AddsAStrayZeroAfterACharacter) {
  TwoOnALine line;
  NoiseRates rates;
  rates.stray_zero = 1;
  const Noise noise(line.wires, rates, 1);
  line.send({0x41});
  EXPECT_EQ(line.heard, (Heard{{0x41, ByteStatus::Good}, {0x00, ByteStatus::Good}}));
}

TEST(Noise, LosesCharactersInContentionOnlyWhileAnotherDriverIsEnabled) {
  TwoOnALine line;
  NoiseRates rates;
  rates.lost_in_contention = 1;
  const Noise noise(line.wires, rates, 1);
  line.send({0x41});
  EXPECT_EQ(line.heard, (Heard{{0x41, ByteStatus::Good}}));

  struct Holder final : Station {
    void run() override {}
  } holder;
  line.wires.attach(holder).drive(true);
  line.heard.clear();
  line.send({0x41});
  EXPECT_EQ(line.heard, Heard());
}

Heard what_is_heard(std::uint64_t seed) {
  TwoOnALine line;
  const Noise noise(line.wires, {0.01, 0.01, 0.01, 0.01, 0}, seed);
  line.send(std::vector<std::uint8_t>(500, 0x5A));
  return line.heard;
}

TEST(Noise, IsReproducibleFromItsSeed) {
  EXPECT_EQ(what_is_heard(1), what_is_heard(1));
  EXPECT_NE(what_is_heard(1), what_is_heard(2));
}

TEST(Echo, WaitsForAPauseEvenIfItReceivesMoreBytesThanItRepeats) {
  constexpr std::size_t kMost = 1024;
  TwoOnALine line;
  Echo echo(line.wires, {9600});
  echo.switch_on(milliseconds(5));
  const std::vector<std::uint8_t> bytes(kMost + 20, 0x55);
  line.sender.send(bytes.data(), bytes.size());
  line.wires.run_for(line.sender.takes(bytes.size()) + milliseconds(4));
  EXPECT_EQ(line.heard.size(), bytes.size());
  line.wires.run_for(seconds(3));
  EXPECT_EQ(line.heard, Heard(bytes.size() + kMost, {0x55, ByteStatus::Good}));
}

}  // namespace
}  // namespace ex9000::sim
