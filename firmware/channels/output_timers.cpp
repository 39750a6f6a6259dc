#include "firmware/channels/output_timers.hpp"

#include "firmware/expect.hpp"

namespace ex9000 {

namespace {

constexpr Duration kUnit = milliseconds(100);
/// `start` gets the time at which the pass began; the same pass switches the output on, at most 300 us later.
/// So a timer runs 300 us longer: the output is never on for less than the requested time.
constexpr Duration kLateStart(300);

}  // namespace

void OutputTimers::start(unsigned channel, std::uint16_t units, Time now) {
  EX9000_EXPECT(units != 0);
  timers_[channel].units = units;
  timers_[channel].unit_end.set(now + kUnit + kLateStart);
  running_ = static_cast<std::uint16_t>(running_ | 1U << channel);
}

std::uint16_t OutputTimers::expire(Time now) {
  std::uint16_t over = 0;
  for (unsigned channel = 0; running_ >> channel != 0; ++channel) {
    Timer& timer = timers_[channel];
    while (is_running(channel) && timer.unit_end.reached(now)) {
      timer.unit_end.postpone(kUnit);
      --timer.units;
      if (timer.units == 0) {
        const auto bit = static_cast<std::uint16_t>(1U << channel);
        over = static_cast<std::uint16_t>(over | bit);
        stop(bit);
      }
    }
  }
  return over;
}

std::uint16_t OutputTimers::left(unsigned channel) const {
  return is_running(channel) ? timers_[channel].units : std::uint16_t{0};
}

Deadline OutputTimers::next_end() const {
  Deadline next;
  for (unsigned channel = 0; running_ >> channel != 0; ++channel) {
    if (is_running(channel)) {
      next.advance_to(timers_[channel].unit_end);
    }
  }
  return next;
}

}  // namespace ex9000
