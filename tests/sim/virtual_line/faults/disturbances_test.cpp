#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/faults/echo.hpp"
#include "sim/virtual_line/faults/noise.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "sim/virtual_line/wires/master.hpp"
#include "sim/virtual_line/wires/wires.hpp"
#include "tests/sim/virtual_line/wires/wires_recorder.hpp"

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

struct Flips final : Disturbance {
  explicit Flips(Levels which) : mask(which) {}
  Levels disturbed(const Sent& sent) override {
    return static_cast<Levels>(sent.levels ^ std::exchange(mask, Levels{0}));
  }
  Levels mask;
};

TEST(Disturbance, OfADataBitChangesOnlyThatByte) {
  TwoOnALine line;
  Flips flips(1U << 3U);
  line.wires.disturb(flips);
  line.send({0x55, 0x12});
  EXPECT_EQ(line.heard, (Heard{{0x51, ByteStatus::Good}, {0x12, ByteStatus::Good}}));
}

TEST(Disturbance, OfTheStopBitCausesAFramingErrorOrABreak) {
  for (const auto& [byte, status] : Heard{{0xF0, ByteStatus::FramingError}, {0x00, ByteStatus::Break}}) {
    TwoOnALine line;
    Flips flips(1U << 9U);
    line.wires.disturb(flips);
    line.send({static_cast<std::uint8_t>(byte)});
    EXPECT_EQ(line.heard, (Heard{{byte, status}}));
  }
}

TEST(Disturbance, OfTheStartBitMakesTheFirstZeroBitTheStartBit) {
  TwoOnALine line;
  Flips flips(1U << 0U);
  line.wires.disturb(flips);
  // The data bits on the wires are 1 0 1 1 0 1 0 0. After the first 0, the receiver reads 1 1 0 1 0 0, the
  // stop bit, and the level 1 of the idle line.
  line.send({0x2D});
  EXPECT_EQ(line.heard, (Heard{{0xCB, ByteStatus::Good}}));
}

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

TEST(Echo, RepeatsTheBytesThatItReceivesWhileItIsOn) {
  TwoOnALine line;
  Echo echo(line.wires, {9600});
  echo.switch_on(milliseconds(5));
  line.send({1, 2, 3});
  EXPECT_EQ(line.heard, (Heard{{1, ByteStatus::Good},
                               {2, ByteStatus::Good},
                               {3, ByteStatus::Good},
                               {1, ByteStatus::Good},
                               {2, ByteStatus::Good},
                               {3, ByteStatus::Good}}));
  echo.switch_off();
  line.heard.clear();
  line.send({4});
  EXPECT_EQ(line.heard, (Heard{{4, ByteStatus::Good}}));
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

TEST(Module, ALateDriverHoldsTheLineForTheGivenTime) {
  for (const VirtualTime late : {VirtualTime(0), VirtualTime(milliseconds(7))}) {
    Line line({parse_module_spec("EX9042D-M@01,protocol=ascii")}, kPaced, [](std::uint8_t, ByteStatus) {});
    WiresRecorder recorder;
    line.wires().observe(recorder);
    line.module(0).release_driver_late(late);
    line.come_up();
    const std::uint8_t request[] = {'$', '0', '1', 'M', '\r'};
    line.master().send(request, sizeof request);
    line.wires().run_for(seconds(1));
    ASSERT_FALSE(recorder.drivers.empty());
    EXPECT_EQ(recorder.drivers.back().station, 1U);
    const VirtualTime held = recorder.drivers.back().at - recorder.bytes.back().end;
    EXPECT_GE(held.count(), late.count());
    EXPECT_LE(held.count(), (late + VirtualTime(std::chrono::microseconds(3))).count());
  }
}

}  // namespace
}  // namespace ex9000::sim
