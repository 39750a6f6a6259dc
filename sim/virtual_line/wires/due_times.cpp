#include "sim/virtual_line/wires/due_times.hpp"

namespace ex9000::sim {

std::size_t DueTimes::add() {
  if (stations_ == times_.size()) {
    times_.resize(stations_ + kBlock, kNever);
    earliest_of_.push_back(kNever);
  }
  return stations_++;
}

void DueTimes::search() const {
  earliest_ = kNever;
  for (std::size_t block = 0; block < earliest_of_.size(); ++block) {
    if (earliest_of_[block] == kUnknown) {
      const VirtualTime* const begin = times_.data() + block * kBlock;
      const VirtualTime* const end = times_.data() + std::min(stations_, (block + 1) * kBlock);
      earliest_of_[block] = *std::min_element(begin, end);
    }
    earliest_ = std::min(earliest_, earliest_of_[block]);
  }
}

}  // namespace ex9000::sim
