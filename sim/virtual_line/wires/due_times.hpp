// Stores the times at which stations have to run, and finds the earliest time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualTime;

/// One due time for each station, at the leaves of a tree whose other nodes are the earlier of the two below
/// them.
class DueTimes {
 public:
  /// Adds a station without a due time. Returns its number, counted from 0.
  std::size_t add() {
    if (stations_ == leaves_) {
      grow();
    }
    return stations_++;
  }
  /// Replaces the due time of a station; kNever: the station has none.
  void set(std::size_t station, VirtualTime when) {
    earliest_[leaves_ + station] = when;
    update_above(leaves_ + station);
  }
  /// Returns the earliest due time; kNever if there is none.
  [[nodiscard]] VirtualTime next() const { return earliest_[1]; }

  /// Calls `run` with the number of each station whose due time is not after `now`, until no station is due.
  /// The next station is always the due station with the lowest number. Removes the due time of a station
  /// before the call for this station. `run` may set due times of all stations, but it must not call
  /// `run_due` or `next`.
  template <class Run>
  void run_due(VirtualTime now, Run run) {
    while (next() <= now) {
      std::size_t node = 1;
      while (node < leaves_) {
        node *= 2;
        node += earliest_[node] <= now ? 0U : 1U;
      }
      const std::size_t station = node - leaves_;
      earliest_[node] = kNever;
      run(station);  // most stations set their next time, so the nodes above are updated once
      if (earliest_[leaves_ + station] == kNever) {
        update_above(leaves_ + station);
      }
    }
  }

 private:
  void update_above(std::size_t node) {
    while (node > 1) {
      node /= 2;
      const VirtualTime earlier = std::min(earliest_[2 * node], earliest_[2 * node + 1]);
      if (earliest_[node] == earlier) {
        return;
      }
      earliest_[node] = earlier;
    }
  }
  /// Doubles the number of leaves.
  void grow() {
    const std::vector<VirtualTime> before(earliest_.begin() + static_cast<std::ptrdiff_t>(leaves_),
                                          earliest_.end());
    leaves_ *= 2;
    earliest_.assign(2 * leaves_, kNever);
    for (std::size_t station = 0; station < before.size(); ++station) {
      set(station, before[station]);
    }
  }

  std::size_t stations_ = 0;
  std::size_t leaves_ = 1;  ///< a power of two
  /// Node n is above the nodes 2n and 2n + 1; the leaves are at the end. Node 0 is not used.
  std::vector<VirtualTime> earliest_{kNever, kNever};
};

}  // namespace ex9000::sim
