// When each station is due, and the earliest of these times.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualTime;

/// A tree: the leaves are the due times of the stations, each other node the earlier of the two below it.
class DueTimes {
 public:
  /// Returns the number of a new station, from 0, that is not due.
  std::size_t add() {
    if (stations_ == leaves_) {
      grow();
    }
    return stations_++;
  }
  /// kNever: not due.
  void set(std::size_t station, VirtualTime when) {
    earliest_[leaves_ + station] = when;
    update_above(leaves_ + station);
  }
  [[nodiscard]] VirtualTime next() const { return earliest_[1]; }

  /// Calls `run` for the due station with the lowest number, until none is due at `now`; clears its due time
  /// first. `run` may set any due times, but must not call `run_due` or `next`.
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
  /// Node n is above nodes 2n and 2n + 1; the leaves are last. Node 0 is not used.
  std::vector<VirtualTime> earliest_{kNever, kNever};
};

}  // namespace ex9000::sim
