// The times at which stations have to run, the earliest first.
#pragma once

#include <cstddef>
#include <optional>
#include <queue>
#include <vector>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualTime;

/// Each station has one due time. Moving it to a later time costs almost nothing: the queue finds out when
/// the earlier time is reached. Receivers do this with every byte, because it restarts their silence timer.
class DueTimes {
 public:
  /// Adds a station, due never, and returns its number, counted from 0.
  std::size_t add();
  /// Sets the due time of a station in place of its last one; kNever: none.
  void set(std::size_t station, VirtualTime when);
  /// Returns the earliest due time; kNever if there is none.
  VirtualTime next();
  /// Returns the first of the stations that are due at `now` and removes its due time. Stations with the same
  /// due time are in the order of their numbers.
  std::optional<std::size_t> take(VirtualTime now);

 private:
  struct Entry {
    VirtualTime when;
    std::size_t station;
    bool operator>(const Entry& other) const {
      return when != other.when ? when > other.when : station > other.station;
    }
  };
  struct Times {
    VirtualTime due = kNever;
    VirtualTime queued = kNever;  ///< the earliest entry of this station; kNever: it has no entry
  };

  void push(std::size_t station);

  std::vector<Times> stations_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

}  // namespace ex9000::sim
