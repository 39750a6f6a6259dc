#include "sim/bus/due_times.hpp"

namespace ex9000::sim {

std::size_t DueTimes::add() {
  stations_.emplace_back();
  return stations_.size() - 1;
}

void DueTimes::set(std::size_t station, VirtualTime when) {
  stations_[station].due = when;
  if (when < stations_[station].queued) {
    push(station);
  }
}

void DueTimes::push(std::size_t station) {
  stations_[station].queued = stations_[station].due;
  queue_.push({stations_[station].due, station});
}

VirtualTime DueTimes::next() {
  while (!queue_.empty()) {
    const Entry first = queue_.top();
    Times& times = stations_[first.station];
    const bool earliest = first.when == times.queued;  // otherwise an earlier entry has replaced this one
    if (earliest && first.when == times.due) {
      return first.when;
    }
    queue_.pop();
    if (earliest) {
      times.queued = kNever;
      set(first.station, times.due);
    }
  }
  return kNever;
}

std::optional<std::size_t> DueTimes::take(VirtualTime now) {
  if (next() > now) {
    return std::nullopt;
  }
  const std::size_t station = queue_.top().station;
  queue_.pop();
  stations_[station] = {};
  return station;
}

}  // namespace ex9000::sim
