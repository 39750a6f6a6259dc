// The microsecond timer as clock, its alarms as one-shot timers. Source: RP2040 data sheet, 4.6 and 4.7.2.
#pragma once

#include <cstdint>

#include "firmware/time.hpp"
#include "hal/registers/register.hpp"
#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// Counts microseconds while the watchdog's tick runs; see HardwareWatchdog::start.
class Clock {
 public:
  [[nodiscard]] static Time now() { return Time(kTime.read().value()); }
  [[nodiscard, gnu::always_inline]] static Time now_in_interrupt() { return now(); }

 private:
  struct Microseconds;
  static constexpr Register<Microseconds> kTime{0x4005'4028};
};

/// `number`: of the alarm, 0 to 3.
template <unsigned number>
class OneShotTimer {
 public:
  static void start() { kEnable.set(Bits<Enable>(kThis)); }

  static void restart(Duration after) {
    kArmed.write(Bits<Armed>(kThis));  // a write disarms
    kForce.clear(Bits<Force>(kThis));
    kRaw.write(Bits<Raw>(kThis));  // a write clears
    // One microsecond more, because a part of the current one has passed: never early.
    const Time begin = Clock::now();
    const Duration to_alarm = after + Duration(1);
    kAlarm.write(Bits<Alarm>((begin + to_alarm).microseconds()));
    // An alarm fires only when the time equals it: the interrupt is forced if another one delayed the write.
    if (!(Clock::now().since(begin) < to_alarm) && kArmed.read().has(Bits<Armed>(kThis))) {
      kArmed.write(Bits<Armed>(kThis));
      kForce.set(Bits<Force>(kThis));
    }
  }

  static bool take_expiry() {
    if (!kStatus.read().has(Bits<Status>(kThis))) {
      return false;
    }
    kForce.clear(Bits<Force>(kThis));
    kRaw.write(Bits<Raw>(kThis));
    return true;
  }

 private:
  static_assert(number < 4, "number: must be 0 to 3");
  static constexpr std::uint32_t kThis = 1U << number;

  struct Alarm;
  struct Armed;
  struct Raw;
  struct Enable;
  struct Force;
  struct Status;
  static constexpr Register<Alarm> kAlarm{0x4005'4010U + 4U * number};
  static constexpr Register<Armed> kArmed{0x4005'4020};
  static constexpr Register<Raw> kRaw{0x4005'4034};
  static constexpr SharedRegister<Enable> kEnable{0x4005'4038};
  static constexpr SharedRegister<Force> kForce{0x4005'403C};
  static constexpr Register<Status> kStatus{0x4005'4040};
};

}  // namespace ex9000::hal::rp2040
