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

}  // namespace
}  // namespace ex9000
