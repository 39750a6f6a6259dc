// The times at which stations have to run, the earliest first.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualTime;

/// Each station has one due time. The times are the leaves of a binary tree. Each other node holds the
/// earlier time of its two children. If many stations set the same time in turn, for example receivers after
/// each byte, half of the changes end at the first node above the leaf, and few reach the root.
class DueTimes {
 public:
  /// Adds a station without a due time. Returns its number, counted from 0.
  std::size_t add();
  /// Sets the due time of a station in place of its last one; kNever: none.
  void set(std::size_t station, VirtualTime when);
  /// Returns the earliest due time; kNever if there is none.
  [[nodiscard]] VirtualTime next() const { return tree_[kRoot]; }
  /// Returns the station with the earliest due time, if that is not after `now`, and removes the due time. If
  /// several stations have the same due time, returns the lowest number. Returns nullopt if no station is
  /// due.
  std::optional<std::size_t> take(VirtualTime now);

 private:
  static constexpr std::size_t kRoot = 1;

  [[nodiscard]] std::size_t leaves() const { return tree_.size() / 2; }

  std::size_t stations_ = 0;
  /// The children of node n are 2n and 2n + 1; the second half of the nodes are the leaves.
  std::vector<VirtualTime> tree_{kNever, kNever};
};

}  // namespace ex9000::sim
