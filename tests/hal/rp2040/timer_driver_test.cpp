// Tests the alarms as one-shot timers, also if an interrupt delays `restart`. Source: RP2040 data sheet, 4.6.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "hal/rp2040/timer.hpp"
#include "tests/hal/rp2040/bus.hpp"

namespace ex9000 {
namespace {

/// One alarm of the timer. An alarm fires when the time becomes equal to its value.
class TimerModel final : public rp2040_model::Bus {
 public:
  explicit TimerModel(unsigned number = 0) : number_(number) {}

  static constexpr std::uint32_t kBase = 0x4005'4000;
  static constexpr std::uint32_t kSet = 0x2000;
  static constexpr std::uint32_t kClear = 0x3000;

  std::uint32_t read(std::uint32_t address) override {
    access();
    switch (address - kBase) {
      case 0x20:
        return armed_ ? bit() : 0;
      case 0x28:
        return static_cast<std::uint32_t>(nanoseconds / 1000);
      case 0x40:
        return interrupt() ? bit() : 0;
      default:
        throw std::runtime_error("an unknown register is read");
    }
  }
  void write(std::uint32_t address, std::uint32_t value) override {
    access();
    if (address == kBase + 0x10 + 4 * number_) {
      alarm_ = value;
      armed_ = true;
      return;
    }
    const bool is_mine = value == bit();
    switch (address - kBase) {
      case 0x20:
        armed_ = armed_ && !is_mine;
        break;
      case 0x34:
        raw_ = raw_ && !is_mine;
        break;
      case 0x38 + kSet:
        enabled_ = enabled_ || is_mine;
        break;
      case 0x3C + kSet:
        forced_ = forced_ || is_mine;
        break;
      case 0x3C + kClear:
        forced_ = forced_ && !is_mine;
        break;
      default:
        throw std::runtime_error("an unknown register is written");
    }
  }
  [[nodiscard]] bool interrupt() const { return (raw_ && enabled_) || forced_; }
  /// Lets `duration` nanoseconds pass, in steps that skip no microsecond.
  void pass(std::uint64_t duration) {
    constexpr std::uint64_t kStep = 100;
    for (const std::uint64_t end = nanoseconds + duration; nanoseconds < end;) {
      const std::uint64_t before = nanoseconds / 1000;
      nanoseconds += std::min(kStep, end - nanoseconds);
      if (armed_ && nanoseconds / 1000 != before &&
          static_cast<std::uint32_t>(nanoseconds / 1000) == alarm_) {
        armed_ = false;
        raw_ = true;
      }
    }
  }
  /// Delays a later access by `duration` nanoseconds, as an interrupt would. `access` 0 is the next access.
  void delay(int access, std::uint64_t duration) {
    delayed_ = accesses_ + access;
    delay_ = duration;
  }

  std::uint64_t nanoseconds = 0;

 private:
  [[nodiscard]] std::uint32_t bit() const { return 1U << number_; }
  void access() { pass(accesses_++ == delayed_ ? delay_ : 16); }

  unsigned number_;
  bool armed_ = false;
  bool raw_ = false;
  bool enabled_ = false;
  bool forced_ = false;
  std::uint32_t alarm_ = 0;
  int accesses_ = 0;
  int delayed_ = -1;
  std::uint64_t delay_ = 0;
};

using Timer = hal::rp2040::OneShotTimer<0>;

/// Lets time pass until the interrupt is pending. Returns the number of nanoseconds that have passed. If more
/// than 100 ms pass, the test fails.
std::uint64_t time_to_interrupt(TimerModel& model) {
  const std::uint64_t begin = model.nanoseconds;
  while (!model.interrupt()) {
    model.pass(100);
    if (model.nanoseconds - begin > 100'000'000) {
      ADD_FAILURE() << "the timer does not fire";
      break;
    }
  }
  return model.nanoseconds - begin;
}

TEST(OneShotTimer, FiresOnceAndNeverEarlyAndAtMostFiveMicrosecondsLate) {
  for (const std::uint64_t start : {0ULL, 1ULL, 999ULL, 4'294'967'290'500ULL}) {
    for (const std::uint32_t after : {1U, 2U, 60U, 1042U, 34'000U}) {
      TimerModel model;
      Timer::start();
      model.nanoseconds = start;
      Timer::restart(Duration(after));
      time_to_interrupt(model);
      EXPECT_GE(model.nanoseconds - start, after * 1000ULL);
      EXPECT_LE(model.nanoseconds - start, after * 1000ULL + 5000);
      EXPECT_TRUE(Timer::take_expiry());
      EXPECT_FALSE(model.interrupt());
      EXPECT_FALSE(Timer::take_expiry());
      model.pass(100'000);
      EXPECT_FALSE(model.interrupt());
    }
  }
}

template <unsigned number>
void expect_that_it_fires() {
  TimerModel model(number);
  hal::rp2040::OneShotTimer<number>::start();
  hal::rp2040::OneShotTimer<number>::restart(Duration(10));
  EXPECT_FALSE(model.interrupt());
  time_to_interrupt(model);
  EXPECT_TRUE(hal::rp2040::OneShotTimer<number>::take_expiry());
  EXPECT_FALSE(model.interrupt());
}

TEST(OneShotTimer, EachTimerUsesItsOwnAlarm) {
  expect_that_it_fires<0>();
  expect_that_it_fires<1>();
  expect_that_it_fires<2>();
  expect_that_it_fires<3>();
}

TEST(OneShotTimer, FiresAlsoIfAnInterruptDelaysItsStart) {
  constexpr int kAccesses = 7;
  for (int access = 0; access < kAccesses; ++access) {
    for (const std::uint64_t delay : {500ULL, 1000ULL, 1900ULL, 2000ULL, 3000ULL, 50'000ULL}) {
      TimerModel model;
      Timer::start();
      model.delay(access, delay);
      Timer::restart(Duration(2));
      EXPECT_LE(time_to_interrupt(model), 3000U) << access << ", " << delay;
      EXPECT_TRUE(Timer::take_expiry());
      model.pass(100'000);
      EXPECT_FALSE(model.interrupt());
      // The counter of the timer has the same values again after 2^32 us.
      model.nanoseconds += (1ULL << 32U) * 1000 - 200'000;
      model.pass(200'000);
      EXPECT_FALSE(model.interrupt()) << "the alarm is still armed: " << access << ", " << delay;
    }
  }
}

// If the delay is between the read of the time and the write of the alarm (access 4), the driver forces the
// interrupt. With each other delay, the alarm fires normally.
TEST(OneShotTimer, RestartCancelsAPendingInterruptAfterADelayedStart) {
  for (int access = 0; access < 8; ++access) {
    TimerModel model;
    Timer::start();
    model.delay(access, 50'000);
    Timer::restart(Duration(2));
    model.pass(5'000);
    ASSERT_TRUE(model.interrupt()) << access;
    Timer::restart(Duration(100));
    EXPECT_FALSE(model.interrupt()) << access;
  }
}

TEST(OneShotTimer, RestartCancelsAnEarlierStartAndItsPendingInterrupt) {
  TimerModel model;
  Timer::start();
  Timer::restart(Duration(10));
  model.pass(20'000);
  EXPECT_TRUE(model.interrupt());
  Timer::restart(Duration(100));
  EXPECT_FALSE(model.interrupt());
  EXPECT_FALSE(Timer::take_expiry());
  Timer::restart(Duration(50));
  model.pass(49'000);
  EXPECT_FALSE(model.interrupt());
  model.pass(3'000);
  EXPECT_TRUE(Timer::take_expiry());
  model.pass(100'000);
  EXPECT_FALSE(model.interrupt());
}

}  // namespace
}  // namespace ex9000
