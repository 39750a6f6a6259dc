// Tests SysTick as the clock, the one-shot timers, the watchdog and the reason of a reset.
#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "hal/cortex_m/system_timer.hpp"
#include "hal/stellaris/one_shot_timer.hpp"
#include "hal/stellaris/system_control.hpp"
#include "hal/stellaris/watchdog.hpp"
#include "tests/mcu_model/driver_bench.hpp"

namespace ex9000::registers {
namespace {

using hal::cortex_m::SystemTimer;
using hal::stellaris::HardwareWatchdog;
using hal::stellaris::OneShotTimer;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr std::uint32_t kMegahertz = 50;

// --- SysTick ---

class Clock : public testing::Test {
 protected:
  Clock() {
    bench.serve_tick([this] {
      timer.count_in_interrupt();
      look();  // a handler may also read the clock
    });
    timer.start();
    began_ = bench.now();
  }

  /// Reads the clock and compares the result with the true time and with the previous result.
  void look() {
    const Instant before = bench.now();
    const std::uint32_t shown = timer.now().microseconds();
    const Instant after = bench.now();
    // The clock returns whole microseconds. The time must be between the call and the return, with a
    // tolerance of 1 us on each side.
    const auto least =
        static_cast<std::uint32_t>(std::chrono::duration_cast<microseconds>(before - began_).count());
    const auto most =
        static_cast<std::uint32_t>(std::chrono::duration_cast<microseconds>(after - began_).count());
    EXPECT_LE(shown - offset_ - (least - 1), most - least + 2)
        << "the clock returned " << shown - offset_ << " us; expected " << least << " to " << most
        << " us, with a tolerance of 1 us";
    EXPECT_LT(shown - last_, 0x8000'0000U) << "the clock went back from " << last_ << " to " << shown;
    last_ = shown;
  }

  DriverBench bench;
  SystemTimer<kMegahertz> timer;
  Instant began_{0};
  std::uint32_t offset_ = 0;
  std::uint32_t last_ = 0;
};

TEST_F(Clock, IsExactToTheMicrosecondInEveryPhaseAroundATick) {
  // The accesses of one call of `now` are two clock cycles apart. Each round of the loop begins one clock
  // cycle later relative to the moment at which the counter reaches 0, so the loop covers every phase.
  for (int clocks = -40; clocks <= 40; ++clocks) {
    bench.mcu.run_until(began_ + milliseconds(20 * (clocks + 50)) + clocks * nanoseconds(20));
    for (int i = 0; i < 10; ++i) {
      look();
    }
  }
}

TEST_F(Clock, IsExactToTheMicrosecondInEveryPhaseWhileTheTickInterruptIsDelayed) {
  for (int clocks = -40; clocks <= 40; ++clocks) {
    bench.mcu.run_until(began_ + milliseconds(20 * (clocks + 50)) + clocks * nanoseconds(20) -
                        microseconds(1));
    bench.mcu.core.hold(true);  // as in an interrupt
    for (int i = 0; i < 20; ++i) {
      look();
    }
    bench.timeline.advance(bench.now() + microseconds(9'000));
    look();
    bench.mcu.core.hold(false);
    look();
  }
}

TEST_F(Clock, NeverGoesBackWhenItIsReadAtRandomTimes) {
  std::mt19937 random(1);
  for (int i = 0; i < 20'000; ++i) {
    const bool hold = random() % 4 == 0;
    bench.mcu.core.hold(hold);
    look();
    const auto wait = nanoseconds(20 * (random() % (i % 3 == 0 ? 300'000 : 40)));
    if (hold) {
      bench.timeline.advance(bench.now() + wait);
      look();
      bench.mcu.core.hold(false);
    } else {
      bench.mcu.run_for(wait);
    }
    look();
  }
}

TEST_F(Clock, WrapsWithoutAJump) {
  constexpr std::uint32_t kTicksBefore = 429'496;  // 2^32 us are 429,496.7296 ticks of 10 ms
  for (std::uint32_t i = 0; i < kTicksBefore; ++i) {
    timer.count_in_interrupt();
  }
  offset_ = last_ = kTicksBefore * 10'000;
  for (int i = 0; i < 200; ++i) {
    look();
    bench.mcu.run_for(microseconds(97));
  }
  EXPECT_LT(last_, 100'000U) << "the clock must have wrapped";
}

// --- one-shot timers ---

template <class Timer>
class OneShot : public testing::Test {};
using Timers =
    testing::Types<OneShotTimer<0, kMegahertz>, OneShotTimer<1, kMegahertz>, OneShotTimer<2, kMegahertz>>;
TYPED_TEST_SUITE(OneShot, Timers);

template <class Timer>
constexpr unsigned kInterruptOf = kTimer0Interrupt;
template <>
constexpr unsigned kInterruptOf<OneShotTimer<1, kMegahertz>> = kTimer1Interrupt;
template <>
constexpr unsigned kInterruptOf<OneShotTimer<2, kMegahertz>> = kTimer2Interrupt;

template <class Timer>
class OneShotBench : public DriverBench {
 public:
  OneShotBench() {
    Timer::start();
    serve(kInterruptOf<Timer>, [this] {
      ++interrupts;
      if (Timer::take_expiry()) {
        fired.push_back(now());
      }
    });
  }
  std::vector<Instant> fired;
  unsigned interrupts = 0;
};

TYPED_TEST(OneShot, FiresOnceAndNeverEarlyAndAtMost5usLate) {
  for (const unsigned after : {1U, 80U, 87U, 100U, 1000U, 1750U, 4011U, 9999U, 34'000U}) {
    OneShotBench<TypeParam> bench;
    const Instant begun = bench.now();
    TypeParam::restart(Duration(after));
    bench.mcu.run_for(milliseconds(100));
    ASSERT_EQ(bench.fired.size(), 1U);
    EXPECT_GE(bench.fired[0], begun + microseconds(after));
    EXPECT_LE(bench.fired[0], begun + microseconds(after) + microseconds(5));
    EXPECT_EQ(bench.interrupts, 1U);
  }
}

TYPED_TEST(OneShot, ARestartCancelsThePreviousStart) {
  OneShotBench<TypeParam> bench;
  for (int i = 0; i < 50; ++i) {
    TypeParam::restart(Duration(200));
    bench.mcu.run_for(microseconds(150));
  }
  EXPECT_TRUE(bench.fired.empty());
  const Instant begun = bench.now();
  TypeParam::restart(Duration(80));
  bench.mcu.run_for(milliseconds(10));
  ASSERT_EQ(bench.fired.size(), 1U);
  EXPECT_GE(bench.fired[0], begun + microseconds(80));
}

TYPED_TEST(OneShot, ARestartCancelsAnExpiryWhoseInterruptIsPending) {
  // The loop covers every phase of the accesses of `restart` relative to the moment at which the timer
  // expires.
  for (int clocks = -12; clocks <= 12; ++clocks) {
    OneShotBench<TypeParam> bench;
    TypeParam::restart(Duration(100));
    bench.mcu.core.hold(true);  // as in the interrupt that restarts the timer
    bench.timeline.advance(bench.now() + microseconds(100) + clocks * nanoseconds(20));
    const Instant begun = bench.now();
    TypeParam::restart(Duration(300));
    bench.mcu.core.hold(false);
    bench.mcu.run_for(milliseconds(5));
    ASSERT_EQ(bench.fired.size(), 1U) << clocks;
    EXPECT_GE(bench.fired[0], begun + microseconds(300)) << clocks;
  }
}

// --- watchdog ---

using Watchdog = HardwareWatchdog<kMegahertz>;

TEST(Watchdog, ResetsAfterTwoCountdownsAndWithin1600ms) {
  DriverBench bench;
  Watchdog::start();
  const Instant begun = bench.now();
  EXPECT_THROW(bench.mcu.run_for(milliseconds(1700)), ResetRequest);
  EXPECT_GE(bench.now(), begun + milliseconds(1400));
  EXPECT_LE(bench.now(), begun + milliseconds(1600));
}

TEST(Watchdog, EveryFeedRestartsItBeforeAndAfterTheFirstCountdown) {
  DriverBench bench;
  Watchdog::start();
  for (const int pause : {1, 700, 749, 751, 1400, 1490}) {
    bench.mcu.run_for(milliseconds(pause));
    Watchdog::feed();
    EXPECT_TRUE(bench.mcu.watchdog.locked());
    EXPECT_FALSE(bench.mcu.watchdog.flagged());
  }
  const Instant fed = bench.now();
  EXPECT_THROW(bench.mcu.run_for(milliseconds(1700)), ResetRequest);
  EXPECT_GE(bench.now(), fed + milliseconds(1400));
}

TEST(Watchdog, IsLockedAgainstUnintendedRegisterWrites) {
  DriverBench bench;
  Watchdog::start();
  EXPECT_THROW(bench.mcu.write(WatchdogTimer::kBase + WatchdogTimer::kClear, 1), Fault);
  EXPECT_THROW(bench.mcu.write(WatchdogTimer::kBase + WatchdogTimer::kControl, 3), Fault);
}

// --- reason of a reset ---

/// Returns the reason that `take_reset_reason` returns after these resets. No software clears RESC between
/// them.
ResetReason taken_after(const Chip& chip, const std::vector<ResetCause>& resets) {
  DriverBench bench(chip);
  SystemControl& system_control = bench.mcu.system_control;
  for (const ResetCause cause : resets) {
    system_control.was_reset_by(cause, system_control.causes());
  }
  return hal::stellaris::SystemControl::take_reset_reason();
}

TEST(ReasonOfAReset, IsThatOfTheSupplyOrElseOfTheLastResetOnBothChips) {
  struct Case {
    std::vector<ResetCause> resets;
    ResetReason reason;
  };
  const std::vector<Case> cases{
      {{ResetCause::PowerOn}, ResetReason::PowerOn},
      {{ResetCause::BrownOut}, ResetReason::PowerOn},
      {{ResetCause::Pin}, ResetReason::ResetPin},
      {{ResetCause::Watchdog}, ResetReason::ModuleWatchdog},
      {{ResetCause::Software}, ResetReason::Fault},
      {{}, ResetReason::Unknown},
      {{ResetCause::PowerOn, ResetCause::BrownOut}, ResetReason::PowerOn},
      {{ResetCause::Watchdog, ResetCause::BrownOut}, ResetReason::PowerOn},
      {{ResetCause::Watchdog, ResetCause::Pin}, ResetReason::ResetPin},
  };
  for (const Chip* chip : {&kLm3s6965, &kTm4c123}) {
    for (const Case& each : cases) {
      SCOPED_TRACE(chip->name + std::string(", case ") + std::to_string(&each - cases.data()));
      EXPECT_EQ(taken_after(*chip, each.resets), each.reason);
    }
  }
  // Only on the LM3S6965 does a reset by the pin clear the other causes.
  EXPECT_EQ(taken_after(kTm4c123, {ResetCause::PowerOn, ResetCause::Pin}), ResetReason::PowerOn);
}

TEST(ReasonOfAReset, IsClearedWhenItIsTaken) {
  DriverBench bench;
  SystemControl& system_control = bench.mcu.system_control;
  system_control.was_reset_by(ResetCause::Watchdog, 0);
  system_control.was_reset_by(ResetCause::Software, system_control.causes());
  EXPECT_EQ(hal::stellaris::SystemControl::take_reset_reason(), ResetReason::ModuleWatchdog);
  EXPECT_EQ(system_control.causes(), 0U);
  EXPECT_EQ(hal::stellaris::SystemControl::take_reset_reason(), ResetReason::Unknown);
}

}  // namespace
}  // namespace ex9000::registers
