#include "sim/bus/due_times.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

std::size_t DueTimes::add() {
  if (stations_ == leaves()) {
    const DueTimes before = std::exchange(*this, {});
    tree_.assign(2 * before.tree_.size(), kNever);
    for (; stations_ < before.stations_; ++stations_) {
      set(stations_, before.tree_[before.leaves() + stations_]);
    }
  }
  return stations_++;
}

void DueTimes::set(std::size_t station, VirtualTime when) {
  std::size_t node = leaves() + station;
  tree_[node] = when;
  while (node != kRoot) {
    const VirtualTime earlier = std::min(tree_[node], tree_[node ^ 1U]);
    node /= 2;
    if (tree_[node] == earlier) {
      return;
    }
    tree_[node] = earlier;
  }
}

std::optional<std::size_t> DueTimes::take(VirtualTime now) {
  const VirtualTime when = next();
  if (when > now) {
    return std::nullopt;
  }
  std::size_t node = kRoot;
  while (node < leaves()) {
    node = tree_[2 * node] == when ? 2 * node : 2 * node + 1;
  }
  set(node - leaves(), kNever);
  return node - leaves();
}

}  // namespace ex9000::sim
