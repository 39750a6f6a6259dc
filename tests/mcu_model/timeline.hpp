// Virtual time, and alarms that call a function at a set time. The unit is a picosecond; each clock cycle of
// a simulated microcontroller lasts at least 20,000 ps.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

namespace ex9000::registers {

/// Time since the beginning of the timeline; 64 bits suffice for 106 days.
using Instant = std::chrono::duration<std::int64_t, std::pico>;

constexpr Instant kNever = Instant::max();

class Alarm;

/// Calls alarms in the order in which they are due.
class Timeline {
 public:
  Timeline() = default;
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  [[nodiscard]] Instant now() const { return now_; }
  /// Returns the time at which the next alarm is due; kNever if none is set.
  [[nodiscard]] Instant next();
  /// Calls all alarms that are due up to `to`, each at its time, or immediately if that time has passed.
  /// Afterwards the time is `to`, or later if it was already later.
  void advance(Instant to);

 private:
  friend class Alarm;

  Instant now_{0};
  std::vector<Alarm*> alarms_;
  bool next_known_ = false;
  Alarm* next_ = nullptr;  ///< null if no alarm is set; valid only if `next_known_` is true
  Instant next_at_ = kNever;
};

/// Calls its function once, at the time that the last `set` or `set_after` specifies, unless the alarm is
/// cancelled or destroyed before that time. The timeline must outlive the alarm.
class Alarm {
 public:
  Alarm(Timeline& timeline, std::function<void()> ring);
  ~Alarm();
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  void set(Instant when) {
    // The timeline must search for the next alarm again if this alarm was the next one or may become it.
    timeline_.next_known_ = timeline_.next_known_ && timeline_.next_ != this && when > timeline_.next_at_;
    when_ = when;
  }
  void set_after(Instant delay) { set(timeline_.now() + delay); }
  void cancel() { set(kNever); }
  [[nodiscard]] Instant when() const { return when_; }
  [[nodiscard]] bool is_set() const { return when_ != kNever; }

 private:
  friend class Timeline;

  Timeline& timeline_;
  std::function<void()> ring_;
  Instant when_ = kNever;
};

}  // namespace ex9000::registers
