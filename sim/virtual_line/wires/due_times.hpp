// Stores the times at which stations have to run, and finds the earliest time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualTime;

/// Stores one due time for each station, and the earliest due time of each block of stations. After a change
/// of due times, `next` searches only the blocks that have changed. Often all stations set their times
/// between two calls of `next`, for example after they receive a byte, so `set` must be fast.
class DueTimes {
 public:
  /// Adds a station without a due time. Returns its number, counted from 0.
  std::size_t add();
  /// Replaces the due time of a station; kNever: the station has none.
  void set(std::size_t station, VirtualTime when) {
    times_[station] = when;
    earliest_of_[station / kBlock] = kUnknown;
    earliest_ = kUnknown;
    if (when <= running_) {
      next_to_run_ = std::min(next_to_run_, station);
    }
  }
  /// Returns the earliest due time; kNever if there is none.
  [[nodiscard]] VirtualTime next() const {
    if (earliest_ == kUnknown) {
      search();
    }
    return earliest_;
  }
  /// Calls `run` with the number of each station whose due time is not after `now`, until no station is due.
  /// The next station is always the due station with the lowest number. Removes the due time of a station
  /// before the call for this station. `run` may set due times of all stations, but it must not call
  /// `run_due`.
  template <class Run>
  void run_due(VirtualTime now, Run run) {
    running_ = now;
    for (next_to_run_ = 0; next_to_run_ < stations_;) {
      const std::size_t station = next_to_run_++;
      if (times_[station] <= now) {
        set(station, kNever);
        run(station);
      } else if (station % kBlock == 0 && earliest_of_[station / kBlock] > now) {
        next_to_run_ = station + kBlock;
      }
    }
    running_ = kNotRunning;
  }

 private:
  static constexpr std::size_t kBlock = 8;
  static constexpr VirtualTime kNotRunning = VirtualTime::min();
  static constexpr VirtualTime kUnknown = VirtualTime::min();  ///< a due time has changed since the search

  void search() const;

  std::size_t stations_ = 0;
  std::vector<VirtualTime> times_;                ///< whole blocks; the unused entries are kNever
  VirtualTime running_ = kNotRunning;             ///< the `now` of `run_due` while `run_due` runs
  std::size_t next_to_run_ = 0;                   ///< no station before this one is due at `running_`
  mutable std::vector<VirtualTime> earliest_of_;  ///< the earliest due time of each block, or kUnknown
  mutable VirtualTime earliest_ = kNever;         ///< the earliest due time, or kUnknown
};

}  // namespace ex9000::sim
