// The last frames and notes of a line, for viewers that read them at intervals.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "sim/line_monitor/frames/frame_watch.hpp"

namespace ex9000::sim {

class RecentTraffic {
 public:
  /// A note about the line if `note` has a value, else a frame.
  struct Entry {
    Frame frame;
    std::optional<std::string> note;  ///< `frame.began` is the time of the note
  };

  void add(Entry entry) {
    if (entries_.size() == kKept) {
      entries_.pop_front();
      ++first_;
    }
    entries_.push_back(std::move(entry));
  }

  /// The number of the next entry; they are numbered from 0 in the order of arrival.
  [[nodiscard]] std::uint64_t end() const { return first_ + entries_.size(); }
  /// The first entry to show: at least `from`, still stored, among the last `most`; else `end()` or more.
  [[nodiscard]] std::uint64_t first_of(std::uint64_t from, std::size_t most) const {
    const std::uint64_t newest = end() - std::min<std::uint64_t>(most, end());
    return std::max({from, first_, newest});
  }
  /// `number`: at least a `first_of` since the last `add`, and below `end()`.
  [[nodiscard]] const Entry& entry(std::uint64_t number) const {
    return entries_[static_cast<std::size_t>(number - first_)];
  }

 private:
  static constexpr std::size_t kKept = 512;

  std::deque<Entry> entries_;
  std::uint64_t first_ = 0;  ///< the number of the oldest entry
};

}  // namespace ex9000::sim
