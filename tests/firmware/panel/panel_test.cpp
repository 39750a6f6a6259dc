// Tests the status LED, the two watchdogs and the debouncing of INIT*: wire.md sections 2 and 6, D8, D13.
#include <gtest/gtest.h>

#include "firmware/panel/debounce.hpp"
#include "firmware/panel/status_led.hpp"
#include "firmware/watchdog/host_watchdog.hpp"
#include "firmware/watchdog/module_watchdog.hpp"

namespace ex9000 {
namespace {

using Pattern = StatusLed::Pattern;

/// The last start is 4 ms before the clock wraps, so every longer interval from this start includes the wrap.
constexpr Time kStarts[] = {Time(0), Time(123'456'789), Time(0xFFFF'FFFFU - 4'000)};

Time ms(Time start, std::uint32_t after) { return start + milliseconds(after); }

// --- INIT*, debounced for 10 ms (wire.md D13) ---

TEST(Debounce, TheLevelIsUnknownUntilItIsStableFor10Ms) {
  for (const Time start : kStarts) {
    Debounce debounce;
    debounce.sample(true, start);
    debounce.sample(true, start + Duration(9'999));
    EXPECT_FALSE(debounce.known());
    EXPECT_FALSE(debounce.level());
    debounce.sample(true, start + Duration(10'000));
    EXPECT_TRUE(debounce.known());
    EXPECT_TRUE(debounce.level());
  }
}

TEST(Debounce, TheLevelOfAReleasedSwitchIsAlsoKnownAfter10Ms) {
  Debounce debounce;
  debounce.sample(false, Time(0));
  EXPECT_FALSE(debounce.known());
  debounce.sample(false, Time(10'000));
  EXPECT_TRUE(debounce.known());
  EXPECT_FALSE(debounce.level());
}

TEST(Debounce, RequestsASampleAtLeastEveryMillisecondUntilALevelIsStable) {
  for (const Time start : kStarts) {
    Debounce debounce;
    debounce.sample(true, start);
    std::uint32_t after = 0;
    for (unsigned samples = 0; debounce.next_sample().armed(); ++samples) {
      ASSERT_LT(samples, 20U);
      const Duration wait = debounce.next_sample().remaining(start + Duration(after));
      EXPECT_LE(wait.microseconds(), 1'000U);
      after += wait.microseconds() + (samples == 0 ? 300U : 0U);  // the first of these samples is late
      debounce.sample(true, start + Duration(after));
    }
    EXPECT_EQ(after, 10'000U);
    EXPECT_TRUE(debounce.known());
    debounce.sample(false, start + Duration(after));
    EXPECT_EQ(debounce.next_sample().remaining(start + Duration(after)).microseconds(), 1'000U);
  }
}

TEST(Debounce, EveryBounceRestartsThe10Ms) {
  for (const Time start : kStarts) {
    Debounce debounce;
    bool level = false;
    for (std::uint32_t after = 0; after < 100; after += 5) {
      level = !level;
      debounce.sample(level, ms(start, after));
      EXPECT_FALSE(debounce.known());
    }
    debounce.sample(level, start + Duration(95'000 + 9'999));
    EXPECT_FALSE(debounce.known());
    debounce.sample(level, start + Duration(95'000 + 10'000));
    EXPECT_TRUE(debounce.known());
    EXPECT_EQ(debounce.level(), level);
  }
}

TEST(Debounce, AShortPulseDoesNotChangeTheLevel) {
  Debounce debounce;
  debounce.sample(false, Time(0));
  debounce.sample(false, ms(Time(0), 10));
  debounce.sample(true, ms(Time(0), 20));
  debounce.sample(true, ms(Time(0), 29));
  EXPECT_FALSE(debounce.level());
  debounce.sample(false, ms(Time(0), 30));
  debounce.sample(false, ms(Time(0), 60));
  EXPECT_FALSE(debounce.level());
  EXPECT_TRUE(debounce.known());
}

TEST(Debounce, TheLevelChangesInBothDirectionsIfTheNewLevelIsStable) {
  Debounce debounce;
  debounce.sample(true, Time(0));
  debounce.sample(true, ms(Time(0), 10));
  debounce.sample(false, ms(Time(0), 50));
  EXPECT_TRUE(debounce.level());
  debounce.sample(false, ms(Time(0), 60));
  EXPECT_FALSE(debounce.level());
  debounce.sample(true, ms(Time(0), 100));
  debounce.sample(true, ms(Time(0), 110));
  EXPECT_TRUE(debounce.level());
}

// --- the status LED ---

/// The LED of a module whose main loop runs every millisecond. `after`: time since `start`, in ms.
class LedOverTime {
 public:
  LedOverTime(Pattern pattern, Time start) : pattern_(pattern), start_(start) { led.show(pattern, start); }
  bool lit(std::uint32_t after) {
    for (; shown_ < after; ++shown_) {
      led.show(pattern_, ms(start_, shown_ + 1));
    }
    return led.lit();
  }
  StatusLed led;

 private:
  Pattern pattern_;
  Time start_;
  std::uint32_t shown_ = 0;
};

TEST(StatusLed, IsSteadyFromReset) {
  const StatusLed led;
  EXPECT_TRUE(led.lit());
  EXPECT_EQ(led.pattern(), Pattern::Steady);
  EXPECT_FALSE(led.next_change().armed());
}

TEST(StatusLed, SteadyNeverChanges) {
  LedOverTime led(Pattern::Steady, Time(0));
  for (std::uint32_t after = 0; after < 5'000; ++after) {
    ASSERT_TRUE(led.lit(after)) << after;
  }
  EXPECT_FALSE(led.led.next_change().armed());
}

TEST(StatusLed, FlashesAt2HzWhileTheTimeoutStatusIsSet) {
  for (const Time start : kStarts) {
    LedOverTime led(Pattern::HostTimeout, start);
    for (std::uint32_t after = 0; after < 5'000; ++after) {
      ASSERT_EQ(led.lit(after), after % 500 < 250) << after;
    }
  }
}

TEST(StatusLed, GivesTwoFlashesOf100MsEvery2SWhileTheSettingsAreUnreadable) {
  for (const Time start : kStarts) {
    LedOverTime led(Pattern::SettingsUnreadable, start);
    for (std::uint32_t after = 0; after < 9'000; ++after) {
      const std::uint32_t within = after % 2'000;
      ASSERT_EQ(led.lit(after), within < 100 || (within >= 200 && within < 300)) << after;
    }
  }
}

TEST(StatusLed, ReportsTheTimeOfItsNextChange) {
  for (const Time start : kStarts) {
    StatusLed led;
    led.show(Pattern::HostTimeout, start);
    EXPECT_EQ(led.next_change().remaining(start).microseconds(), 250'000U);
    led.show(Pattern::SettingsUnreadable, start);
    EXPECT_EQ(led.next_change().remaining(start).microseconds(), 100'000U);
  }
}

TEST(StatusLed, IsSteadyImmediatelyAfterThePatternEnds) {
  for (const Pattern pattern : {Pattern::HostTimeout, Pattern::SettingsUnreadable}) {
    LedOverTime led(pattern, Time(0));
    led.lit(300);
    led.led.show(Pattern::Steady, ms(Time(0), 300));
    EXPECT_TRUE(led.led.lit());
    EXPECT_FALSE(led.led.next_change().armed());
  }
}

TEST(StatusLed, ANewPatternStartsWithAFlash) {
  LedOverTime led(Pattern::HostTimeout, Time(0));
  ASSERT_FALSE(led.lit(300));
  led.led.show(Pattern::SettingsUnreadable, ms(Time(0), 300));
  EXPECT_TRUE(led.led.lit());
  led.led.show(Pattern::SettingsUnreadable, ms(Time(0), 399));
  EXPECT_TRUE(led.led.lit());
  led.led.show(Pattern::SettingsUnreadable, ms(Time(0), 400));
  EXPECT_FALSE(led.led.lit());
}

// --- the module watchdog ---

TEST(ModuleWatchdog, IsNotFedBeforeATick) {
  ModuleWatchdog watchdog;
  EXPECT_FALSE(watchdog.main_loop_alive());
  EXPECT_FALSE(watchdog.main_loop_alive());
}

TEST(ModuleWatchdog, IsFedAfterATickAndATurnOfTheMainLoop) {
  ModuleWatchdog watchdog;
  watchdog.tick_alive();
  EXPECT_TRUE(watchdog.main_loop_alive());
}

TEST(ModuleWatchdog, RequiresANewTickForEveryFeed) {
  ModuleWatchdog watchdog;
  watchdog.tick_alive();
  EXPECT_TRUE(watchdog.main_loop_alive());
  EXPECT_FALSE(watchdog.main_loop_alive());
  watchdog.tick_alive();
  watchdog.tick_alive();
  EXPECT_TRUE(watchdog.main_loop_alive());
  EXPECT_FALSE(watchdog.main_loop_alive());
}

TEST(ModuleWatchdog, IsFedInEveryTurnThatFollowsANewTick) {
  ModuleWatchdog watchdog;
  for (int i = 0; i < 1000; ++i) {
    watchdog.tick_alive();
    EXPECT_TRUE(watchdog.main_loop_alive()) << i;
  }
}

TEST(ModuleWatchdog, IsFedInOneOfTwoTurnsAfterAnyNumberOfTicks) {
  for (int ticks = 1; ticks < 1000; ++ticks) {
    ModuleWatchdog watchdog;
    for (int i = 0; i < ticks; ++i) {
      watchdog.tick_alive();
    }
    const bool fed = watchdog.main_loop_alive();
    watchdog.tick_alive();
    EXPECT_TRUE(watchdog.main_loop_alive() || fed) << ticks;
  }
}

// --- the host watchdog: never early, and at most 1 ms late (wire.md section 6) ---

constexpr std::uint32_t kLatest = 1'000;

Settings running(std::uint8_t tenths) {
  Settings settings;
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = tenths;
  return settings;
}

TEST(HostWatchdog, DoesNotRunIfItIsDisabled) {
  HostWatchdog watchdog;
  watchdog.restart(Time(0));
  Settings settings = running(1);
  settings.watchdog_enabled = false;
  EXPECT_FALSE(watchdog.expired(settings, ms(Time(0), 100)));
  EXPECT_FALSE(watchdog.expired(settings, ms(Time(0), 60'000)));
  EXPECT_FALSE(watchdog.expiry(settings).armed());
}

TEST(HostWatchdog, ExpiresAtMost1MsLateAndNeverEarlyForEveryTimeoutValue) {
  for (const Time start : kStarts) {
    for (unsigned tenths = 1; tenths <= 0xFF; ++tenths) {
      HostWatchdog watchdog;
      watchdog.restart(start);
      const Settings settings = running(static_cast<std::uint8_t>(tenths));
      const std::uint32_t timeout = tenths * 100'000;
      EXPECT_FALSE(watchdog.expired(settings, start));
      EXPECT_FALSE(watchdog.expired(settings, start + Duration(timeout - 1))) << tenths;
      EXPECT_TRUE(watchdog.expired(settings, start + Duration(timeout + kLatest))) << tenths;
    }
  }
}

TEST(HostWatchdog, ExpiryReturnsTheTimeOfTheTimeout) {
  for (const Time start : kStarts) {
    HostWatchdog watchdog;
    watchdog.restart(start);
    const Deadline expiry = watchdog.expiry(running(10));
    EXPECT_GE(expiry.remaining(start).microseconds(), 1'000'000U);
    EXPECT_LE(expiry.remaining(start).microseconds(), 1'000'000U + kLatest);
    EXPECT_GE(expiry.remaining(ms(start, 999)).microseconds(), 1'000U);
    EXPECT_EQ(expiry.remaining(ms(start, 1'500)).microseconds(), 0U);
  }
}

TEST(HostWatchdog, ARestartStartsTheFullTimeoutAgain) {
  for (const Time start : kStarts) {
    HostWatchdog watchdog;
    watchdog.restart(start);
    watchdog.restart(ms(start, 99));
    EXPECT_FALSE(watchdog.expired(running(1), ms(start, 198)));
    EXPECT_TRUE(watchdog.expired(running(1), ms(start, 199) + Duration(kLatest)));
  }
}

TEST(HostWatchdog, ARestartLaterThanTheTimeOfTheMainLoopCausesNoExpiry) {
  for (const Time start : kStarts) {
    for (const std::uint32_t ahead : {1U, 1'000U, 99'000U, 500'000U}) {
      HostWatchdog watchdog;
      watchdog.restart(start + Duration(ahead));
      EXPECT_FALSE(watchdog.expired(running(1), start)) << ahead;
      EXPECT_TRUE(watchdog.expired(running(1), start + Duration(ahead + 100'000 + kLatest))) << ahead;
    }
  }
}

TEST(HostWatchdog, DoesNotExpireAcrossClockWrapsWhileItIsRestarted) {
  HostWatchdog watchdog;
  Time now(0);
  for (int i = 0; i < 100'000; ++i) {  // 2.75 hours, more than two wraps of the clock
    watchdog.restart(now);
    now = ms(now, 99);
    ASSERT_FALSE(watchdog.expired(running(1), now)) << i;
  }
}

TEST(HostWatchdog, ANewTimeoutCountsFromTheLastRestart) {
  HostWatchdog watchdog;
  watchdog.restart(Time(0));
  EXPECT_FALSE(watchdog.expired(running(100), ms(Time(0), 5'000)));
  EXPECT_TRUE(watchdog.expired(running(50), ms(Time(0), 5'000) + Duration(kLatest)));
}

}  // namespace
}  // namespace ex9000
