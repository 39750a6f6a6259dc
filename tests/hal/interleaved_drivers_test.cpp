// Tests drivers with an event at each point before or after an access to a register or a shared value. For
// the SysTick driver and the I2C driver, the event is the interrupt with which the driver shares a counter.
// For the input driver, the event is an edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <vector>

#include "firmware/channels/inputs.hpp"
#include "hal/cortex_m/system_timer.hpp"
#include "hal/stellaris/i2c.hpp"
#include "hal/stellaris/inputs.hpp"

namespace ex9000::interleaving {
namespace {

namespace bus = hal::bus;

// --- SysTick ---

constexpr unsigned kMegahertz = 50;
constexpr unsigned kPeriod = 10'000 * kMegahertz;

/// Simulates SysTick. Each read takes `cycles_an_access` cycles. After the counter has restarted, the
/// interrupt waits for `accesses_late` calls of `pass` and runs in the next call. Calls while `held` is true
/// do not count.
class SysTick final : public bus::Peripherals {
 public:
  SysTick(unsigned cycles, unsigned cycles_an_access, unsigned accesses_late)
      : cycles_(cycles), cycles_an_access_(cycles_an_access), accesses_late_(accesses_late) {
    bus::peripherals = this;
  }
  hal::cortex_m::SystemTimer<kMegahertz> timer;

  [[nodiscard]] unsigned microseconds() const { return cycles_ / kMegahertz; }
  /// While this is true, the interrupt waits.
  bool held = false;
  void pass() {
    if (pending() && !held && late_++ >= accesses_late_) {
      Points::interrupt([&] { timer.count_in_interrupt(); });
      ++served_;
      late_ = 0;
    }
  }

  std::uint32_t read(std::uint32_t address) override {
    constexpr std::uint32_t kInterruptControl = 0xE000'ED04;
    cycles_ += cycles_an_access_;
    return address == kInterruptControl ? (pending() ? 1U << 26U : 0) : kPeriod - 1 - cycles_ % kPeriod;
  }
  void write(std::uint32_t /*address*/, std::uint32_t /*value*/) override {}

 private:
  [[nodiscard]] bool pending() const { return cycles_ / kPeriod != served_; }

  unsigned cycles_;
  unsigned cycles_an_access_;
  unsigned accesses_late_;
  unsigned late_ = 0;
  unsigned served_ = 0;
};

TEST(SystemTimer, ReturnsTheCorrectTimeIfATickOccursAtAnyPoint) {
  unsigned asked = 0;
  for (unsigned cycles = kPeriod - 300; cycles < kPeriod + 300; ++cycles) {
    for (const unsigned an_access : {1U, 7U, 40U}) {
      for (const unsigned late : {0U, 1U, 2U}) {
        for (const bool in_interrupt : {false, true}) {
          SysTick tick(cycles, an_access, late);
          tick.pass();
          tick.held = in_interrupt;  // interrupts wait while another one is being served
          const unsigned before = tick.microseconds();
          unsigned told = 0;
          Points::watch([&](unsigned) { tick.pass(); }, [&] { told = tick.timer.now().microseconds(); });
          ASSERT_GE(told, before) << cycles << " " << an_access << " " << late << " " << in_interrupt;
          ASSERT_LE(told, tick.microseconds())
              << cycles << " " << an_access << " " << late << " " << in_interrupt;
          ++asked;
        }
      }
    }
  }
  std::printf("checked readings of the clock: %u\n", asked);
}

// --- I2C ---

/// A free bus and a controller on it. The test decides when a byte is complete.
class I2cController final : public bus::Peripherals {
 public:
  I2cController() { bus::peripherals = this; }
  unsigned bytes_begun = 0;
  bool busy = false;

  std::uint32_t read(std::uint32_t address) override {
    return address == kControl ? (busy ? 1U : 0) : 0xFFFF'FFFF;
  }
  void write(std::uint32_t address, std::uint32_t value) override {
    constexpr std::uint32_t kRun = 1;
    bytes_begun += address == kControl && (value & kRun) != 0 ? 1U : 0U;
  }

 private:
  static constexpr std::uint32_t kControl = 0x4002'0004;
};

/// Begins a transfer, waits until the timeout of its first byte has expired, and completes this byte at point
/// `completes` of the next call of `poll`. If the driver has aborted the transfer, checks that the driver
/// does not use this completion for the next transfer. Returns the number of points of this call of `poll`.
unsigned give_up_a_byte_that_completes(unsigned completes) {
  I2cController controller;
  hal::stellaris::I2c<hal::stellaris::Family::Lm3s, 50'000'000> i2c;
  Time now(0);
  const auto poll_until_free = [&] {
    for (int i = 0; i < 100 && i2c.poll(now); ++i) {
      now = now + Duration(50);
    }
  };
  i2c.start();
  poll_until_free();
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  hal::I2cTransfer transfer;
  transfer.header = {bytes.data(), bytes.size()};
  i2c.begin(transfer, now);
  now = now + milliseconds(4);
  const unsigned points = Points::watch(
      [&](unsigned point) {
        if (point == completes) {
          Points::interrupt([&] { i2c.on_interrupt(); });
        }
      },
      [&] { i2c.poll(now); });
  poll_until_free();
  if (i2c.busy()) {
    return points;  // the byte completed in time, and the next one has begun
  }
  controller.bytes_begun = 0;
  i2c.begin(transfer, now);
  i2c.poll(now);
  EXPECT_EQ(controller.bytes_begun, 1U)
      << "at " << completes << ": the driver used the completion of the previous byte for this byte";
  Points::interrupt([&] { i2c.on_interrupt(); });
  i2c.poll(now);
  EXPECT_EQ(controller.bytes_begun, 2U) << "at " << completes;
  return points;
}

TEST(I2c, TheCompletionOfAnAbandonedByteIsNotUsedForALaterByte) {
  unsigned points = 1;
  for (unsigned point = 0; point < points; ++point) {
    points = std::max(points, give_up_a_byte_that_completes(point));
  }
  std::printf("points: %u\n", points);
  EXPECT_GT(points, 5U);
}

TEST(I2c, AByteFalselyReportedAsCompleteFailsAfterATimeout) {
  I2cController controller;
  hal::stellaris::I2c<hal::stellaris::Family::Lm3s, 50'000'000> i2c;
  Time now(0);
  i2c.start();
  while (i2c.poll(now)) {
    now = now + Duration(50);
  }
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  hal::I2cTransfer transfer;
  transfer.header = {bytes.data(), bytes.size()};
  i2c.begin(transfer, now);
  controller.busy = true;
  Points::interrupt([&] { i2c.on_interrupt(); });
  i2c.poll(now);
  EXPECT_TRUE(i2c.busy());
  EXPECT_EQ(controller.bytes_begun, 1U);
  i2c.poll(now + milliseconds(4));
  EXPECT_FALSE(i2c.busy());
  EXPECT_EQ(i2c.result(), hal::I2cResult::Failed);
}

// --- inputs ---

using hal::stellaris::PinGroup;
using hal::stellaris::Port;

/// Simulates ports of input pins. Source: LM3S6965 data sheet, 8.3.2 and 8.5. Each pin has a raw flag. A
/// falling edge sets the flag. A rising edge sets the flag only if the bit of the pin in GPIOIBE is set. The
/// flag stays set until the driver clears it. A set flag causes an interrupt if its bit in GPIOIM is set.
class InputPorts final : public bus::Peripherals {
 public:
  InputPorts() { bus::peripherals = this; }

  void set(Port port, unsigned pin, bool level) {
    PortState& state = states_[base_of(port)];
    state.wires = level ? state.wires | 1U << pin : state.wires & ~(1U << pin);
    state.look();
  }
  [[nodiscard]] bool level(Port port, unsigned pin) {
    return (states_[base_of(port)].wires >> pin & 1U) != 0;
  }
  [[nodiscard]] bool interrupts(Port port) {
    PortState& state = states_[base_of(port)];
    return (state.raw & state.registers[kMask]) != 0;
  }

  std::uint32_t read(std::uint32_t address) override {
    PortState& state = states_[address & ~kOffset];
    const std::uint32_t offset = address & kOffset;
    if (offset < kFirstControl) {
      return state.shown & offset >> 2U;
    }
    return offset == kMaskedStatus ? state.raw & state.registers[kMask] : state.registers[offset];
  }
  void write(std::uint32_t address, std::uint32_t value) override {
    PortState& state = states_[address & ~kOffset];
    const std::uint32_t offset = address & kOffset;
    if (offset == kClear) {
      state.raw &= ~value;
    } else {
      state.registers[offset] = value;
      state.look();
    }
  }

 private:
  static constexpr std::uint32_t kOffset = 0xFFF;
  static constexpr std::uint32_t kFirstControl = 0x400;
  static constexpr std::uint32_t kBothEdges = 0x408;
  static constexpr std::uint32_t kMask = 0x410;
  static constexpr std::uint32_t kMaskedStatus = 0x418;
  static constexpr std::uint32_t kClear = 0x41C;
  static constexpr std::uint32_t kDigitalEnable = 0x51C;

  struct PortState {
    std::uint32_t wires = 0;
    std::uint32_t shown = 0;  ///< the levels read at the enabled pins
    std::uint32_t raw = 0;
    std::map<std::uint32_t, std::uint32_t> registers;

    void look() {
      const std::uint32_t before = shown;
      shown = wires & registers[kDigitalEnable];
      raw |= (before ^ shown) & (registers[kBothEdges] | before);
    }
  };

  static std::uint32_t base_of(Port port) { return port == Port::B ? 0x4000'5000U : 0x4000'6000U; }

  std::map<std::uint32_t, PortState> states_;
};

constexpr std::array<PinGroup, 3> kInputGroups{PinGroup{Port::B, 4, 2}, PinGroup{Port::C, 5, 2},
                                               PinGroup{Port::B, 0, 1}};
constexpr unsigned kChannels = 5;

/// Channels 0, 1 and 4 are on one port, in two groups, and channels 2 and 3 are on another port.
template <bool active_high>
class InputBench {
 public:
  using Pins = hal::stellaris::InputPins<kInputGroups, kChannels, active_high>;

  /// Bit n of `levels` is channel n.
  explicit InputBench(unsigned levels) {
    for (unsigned channel = 0; channel < kChannels; ++channel) {
      set(channel, (levels >> channel & 1U) != 0);
    }
  }

  void start() {
    Pins::make_inputs();
    baseline_ = Pins::start();
    edges_.begin(baseline_);
  }
  void toggle(unsigned channel) { set(channel, !level(channel)); }
  [[nodiscard]] bool level(unsigned channel) {
    return ports_.level(port_of(channel), pin_of(channel)) == active_high;
  }

  /// Serves the port of `channel` once.
  void serve(unsigned channel) {
    const auto deliver = [this](unsigned of, bool level) {
      Points::interrupt([&] { edges_.on_edge(of, level, Time()); });
    };
    if (port_of(channel) == Port::B) {
      Pins::template take_edges<Port::B>(deliver);
    } else {
      Pins::template take_edges<Port::C>(deliver);
    }
  }
  void serve_what_waits() {
    for (const unsigned channel : {0U, 2U}) {
      for (int i = 0; i < 10 && ports_.interrupts(port_of(channel)); ++i) {
        serve(channel);
      }
      EXPECT_FALSE(ports_.interrupts(port_of(channel))) << "the interrupt of an edge does not end";
    }
  }

  /// Returns the number of edges counted on `channel`. Checks that the level computed from the initial level
  /// and these edges equals the present level of the channel.
  unsigned counted(unsigned channel) {
    const unsigned count = edges_.collect(channel);
    const bool told = ((baseline_ >> channel ^ count) & 1U) != 0;
    EXPECT_EQ(told, level(channel))
        << "channel " << channel
        << ": the level computed from the counted edges differs from the present level";
    return count;
  }

 private:
  static Port port_of(unsigned channel) { return channel == 2 || channel == 3 ? Port::C : Port::B; }
  static unsigned pin_of(unsigned channel) {
    constexpr std::array<unsigned, kChannels> kPins{4, 5, 5, 6, 0};
    return kPins[channel];
  }
  void set(unsigned channel, bool level) {
    ports_.set(port_of(channel), pin_of(channel), level == active_high);
  }

  InputPorts ports_;
  InputEdges edges_;
  std::uint16_t baseline_ = 0;
};

template <class Bench>
class Inputs : public testing::Test {};
using Polarities = testing::Types<InputBench<true>, InputBench<false>>;
TYPED_TEST_SUITE(Inputs, Polarities);

/// Starts the inputs and serves an edge on channel 0. `later`: points of the interrupt that serves this edge,
/// and for each point the channel on which one more edge occurs. Returns the number of points of the
/// interrupt.
template <class Bench>
unsigned serve_an_edge(Bench& bench, const std::vector<std::pair<unsigned, unsigned>>& later) {
  bench.start();
  bench.toggle(0);
  const unsigned points = Points::watch(
      [&](unsigned point) {
        for (const auto& [at, channel] : later) {
          if (at == point) {
            bench.toggle(channel);
          }
        }
      },
      [&] { bench.serve(0); });
  bench.serve_what_waits();
  return points;
}

TYPED_TEST(Inputs, AnEdgeAtAnyPointOfTheInterruptIsCountedInAdditionToTheServedEdge) {
  for (unsigned levels = 0; levels < 1U << kChannels; ++levels) {
    for (unsigned second = 0; second < kChannels; ++second) {
      TypeParam undisturbed(levels);
      const unsigned points = serve_an_edge(undisturbed, {});
      ASSERT_GE(points, 8U) << "each of four accesses has a point before and after it";
      for (unsigned point = 0; point < points; ++point) {
        SCOPED_TRACE("levels " + std::to_string(levels) + ", channel " + std::to_string(second) + ", point " +
                     std::to_string(point));
        TypeParam bench(levels);
        serve_an_edge(bench, {{point, second}});
        for (unsigned channel = 0; channel < kChannels; ++channel) {
          const unsigned edges = (channel == 0 ? 1U : 0U) + (channel == second ? 1U : 0U);
          ASSERT_EQ(bench.counted(channel), edges) << "channel " << channel;
        }
      }
    }
  }
}

TYPED_TEST(Inputs, TheComputedLevelIsThePresentLevelIfUpToTwoMoreEdgesOccurAtAnyPoints) {
  for (const unsigned levels : {0U, 1U}) {
    unsigned points = 1;
    for (unsigned first = 0; first < points; ++first) {
      for (unsigned second = first + 1; second <= points; ++second) {
        SCOPED_TRACE(std::to_string(first) + " and " + std::to_string(second));
        TypeParam bench(levels);
        points = std::max(points, serve_an_edge(bench, {{first, 0}, {second, 0}}));
        const unsigned counted = bench.counted(0);
        EXPECT_GE(counted, 1U);
        EXPECT_LE(counted, 3U);
      }
    }
  }
}

TYPED_TEST(Inputs, AnEdgeDuringStartIsInTheInitialLevelsOrIsCounted) {
  for (unsigned levels = 0; levels < 1U << kChannels; ++levels) {
    for (unsigned moving = 0; moving < kChannels; ++moving) {
      unsigned points = 1;
      for (unsigned at = 0; at < points; ++at) {
        SCOPED_TRACE("levels " + std::to_string(levels) + ", channel " + std::to_string(moving) + ", point " +
                     std::to_string(at));
        TypeParam bench(levels);
        const unsigned passed = Points::watch(
            [&](unsigned point) {
              if (point == at) {
                bench.toggle(moving);
              }
            },
            [&] { bench.start(); });
        points = std::max(points, passed);
        bench.serve_what_waits();
        for (unsigned channel = 0; channel < kChannels; ++channel) {
          ASSERT_LE(bench.counted(channel), channel == moving ? 1U : 0U) << "channel " << channel;
        }
      }
      EXPECT_GT(points, 20U);
    }
  }
}

}  // namespace
}  // namespace ex9000::interleaving
