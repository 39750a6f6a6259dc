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

/// Stores the last 512 entries.
class RecentTraffic {
 public:
  /// A frame, or a note about the line if `note` has a value.
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

  /// Entries are numbered from 0 in the order of arrival. Returns the number of the next entry.
  [[nodiscard]] std::uint64_t end() const { return first_ + entries_.size(); }
  /// Returns the number of the first entry to show. This entry has a number of at least `from`, is still
  /// stored, and is one of the last `most` entries. If there is no such entry, returns `end()` or a higher
  /// number.
  [[nodiscard]] std::uint64_t first_of(std::uint64_t from, std::size_t most) const {
    const std::uint64_t newest = end() - std::min<std::uint64_t>(most, end());
    return std::max({from, first_, newest});
  }
  /// Returns a stored entry. `number` must be at least the result of a call of `first_of` after the last
  /// `add`, and less than `end()`.
  [[nodiscard]] const Entry& entry(std::uint64_t number) const {
    return entries_[static_cast<std::size_t>(number - first_)];
  }

 private:
  static constexpr std::size_t kKept = 512;

  std::deque<Entry> entries_;
  std::uint64_t first_ = 0;  ///< the number of the oldest entry
};

}  // namespace ex9000::sim
