// Virtual time in picoseconds, fine enough for clock cycles of any crystal, and what happens in it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

namespace ex9000::registers {

/// Since the supply came on for the first time; 64 bits last 106 days.
using Instant = std::chrono::duration<std::int64_t, std::pico>;

constexpr Instant kNever = Instant::max();

class Alarm;

/// Rings alarms in the order in which they are due.
class Timeline {
 public:
  Timeline() = default;
  Timeline(const Timeline&) = delete;
  Timeline& operator=(const Timeline&) = delete;

  [[nodiscard]] Instant now() const { return now_; }
  /// When the next alarm is due; kNever: none is set.
  [[nodiscard]] Instant next();
  /// Rings what is due up to `to`, each at its instant; then it is `to`, unless it is later already.
  void advance(Instant to);

 private:
  friend class Alarm;

  Instant now_{0};
  std::vector<Alarm*> alarms_;
  bool next_known_ = false;
  Alarm* next_ = nullptr;  ///< null: none is set
  Instant next_at_ = kNever;
};

/// Rings once each time it is set. Belongs to whoever sets it; the timeline must outlive it.
class Alarm {
 public:
  Alarm(Timeline& timeline, std::function<void()> ring);
  ~Alarm();
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  void set(Instant when) {
    // One that was not the next and is not to be either leaves the next what it is.
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
