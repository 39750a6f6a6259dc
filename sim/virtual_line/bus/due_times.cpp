#include "sim/virtual_line/bus/due_times.hpp"

namespace ex9000::sim {

std::size_t DueTimes::add() {
  if (stations_ == times_.size()) {
    times_.resize(stations_ + kBlock, kNever);
    earliest_of_.push_back(kNever);
    changed_.push_back(0);
  }
  return stations_++;
}

void DueTimes::search() const {
  earliest_ = kNever;
  for (std::size_t block = 0; block < earliest_of_.size(); ++block) {
    if (changed_[block] != 0) {
      changed_[block] = 0;
      const VirtualTime* const begin = times_.data() + block * kBlock;
      const VirtualTime* const end = times_.data() + std::min(stations_, (block + 1) * kBlock);
      earliest_of_[block] = *std::min_element(begin, end);
    }
    earliest_ = std::min(earliest_, earliest_of_[block]);
  }
  any_changed_ = false;
}

}  // namespace ex9000::sim
