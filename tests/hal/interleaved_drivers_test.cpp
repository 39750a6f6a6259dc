// Interrupts at every point of the drivers that share a counter with theirs.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "hal/stellaris/i2c.hpp"
#include "hal/stellaris/system_timer.hpp"

namespace ex9000::interleaving {
namespace {

namespace bus = hal::stellaris::bus;

// --- SysTick ---

constexpr unsigned kMegahertz = 50;
constexpr unsigned kPeriod = 1000 * kMegahertz;

/// Each access takes a few cycles; the interrupt comes when the counter begins anew, or some accesses later.
class SysTick final : public bus::Peripherals {
 public:
  SysTick(unsigned cycles, unsigned cycles_an_access, unsigned accesses_late)
      : cycles_(cycles), cycles_an_access_(cycles_an_access), accesses_late_(accesses_late) {
    bus::peripherals = this;
  }
  hal::stellaris::SystemTimer<kMegahertz> timer;

  [[nodiscard]] unsigned microseconds() const { return cycles_ / kMegahertz; }
  /// Served as soon as it may be; while it is held, it waits.
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

TEST(SystemTimer, TellsTheTimeWhereverItsTickComes) {
  unsigned asked = 0;
  for (unsigned cycles = kPeriod - 300; cycles < kPeriod + 300; ++cycles) {
    for (const unsigned an_access : {1U, 7U, 40U}) {
      for (const unsigned late : {0U, 1U, 2U}) {
        for (const bool in_interrupt : {false, true}) {
          SysTick tick(cycles, an_access, late);
          tick.pass();
          tick.held = in_interrupt;  // it waits for the interrupt that asks, as it does for all of them
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
  std::printf("times told: %u\n", asked);
}

// --- I2C ---

/// A bus that is free, and a controller that is told when a byte is over.
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

/// `completes`: at which point of the turn that gives the byte up. How many points that turn has.
unsigned give_up_a_byte_that_completes(unsigned completes) {
  I2cController controller;
  hal::stellaris::I2c<hal::stellaris::Family::Lm3s, 50'000'000> i2c;
  Time now(0);
  const auto go_on_until_free = [&] {
    for (int i = 0; i < 100 && i2c.go_on(now); ++i) {
      now = now + Duration(50);
    }
  };
  i2c.start();
  go_on_until_free();
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
      [&] { i2c.go_on(now); });
  go_on_until_free();
  if (i2c.busy()) {
    return points;  // it was in time, and the next byte is on its way
  }
  controller.bytes_begun = 0;
  i2c.begin(transfer, now);
  i2c.go_on(now);
  EXPECT_EQ(controller.bytes_begun, 1U) << "at " << completes << ": the byte before was taken for this one";
  Points::interrupt([&] { i2c.on_interrupt(); });
  i2c.go_on(now);
  EXPECT_EQ(controller.bytes_begun, 2U) << "at " << completes;
  return points;
}

TEST(I2c, AByteThatIsGivenUpIsNeverTakenForALaterOne) {
  unsigned points = 1;
  for (unsigned point = 0; point < points; ++point) {
    points = std::max(points, give_up_a_byte_that_completes(point));
  }
  std::printf("points: %u\n", points);
  EXPECT_GT(points, 5U);
}

TEST(I2c, AByteThatIsToldToBeOverAndIsNotIsGivenUpInTheEnd) {
  I2cController controller;
  hal::stellaris::I2c<hal::stellaris::Family::Lm3s, 50'000'000> i2c;
  Time now(0);
  i2c.start();
  while (i2c.go_on(now)) {
    now = now + Duration(50);
  }
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  hal::I2cTransfer transfer;
  transfer.header = {bytes.data(), bytes.size()};
  i2c.begin(transfer, now);
  controller.busy = true;
  Points::interrupt([&] { i2c.on_interrupt(); });
  i2c.go_on(now);
  EXPECT_TRUE(i2c.busy());
  EXPECT_EQ(controller.bytes_begun, 1U);
  i2c.go_on(now + milliseconds(4));
  EXPECT_FALSE(i2c.busy());
  EXPECT_EQ(i2c.result(), hal::I2cResult::Failed);
}

}  // namespace
}  // namespace ex9000::interleaving
