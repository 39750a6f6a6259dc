// What was last said on a line, for those who look at it now and then.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "sim/frame_watch.hpp"

namespace ex9000::sim {

class Heard {
 public:
  /// A frame, or where there is a text a remark on the line.
  struct Entry {
    Frame frame;
    std::optional<std::string> note;  ///< said at the frame's beginning
  };

  void add(Entry entry) {
    if (entries_.size() == kKept) {
      entries_.pop_front();
      ++first_;
    }
    entries_.push_back(std::move(entry));
  }

  /// Entries are numbered from 0, as they come; this is the next one's number.
  [[nodiscard]] std::uint64_t end() const { return first_ + entries_.size(); }
  /// The first of the last `most` from number `from` on: those before have been missed.
  [[nodiscard]] std::uint64_t first_of(std::uint64_t from, std::size_t most) const {
    const std::uint64_t newest = end() - std::min<std::uint64_t>(most, end());
    return std::max({from, first_, newest});
  }
  /// One that `first_of` has told, or a later one.
  [[nodiscard]] const Entry& entry(std::uint64_t number) const {
    return entries_[static_cast<std::size_t>(number - first_)];
  }

 private:
  static constexpr std::size_t kKept = 512;

  std::deque<Entry> entries_;
  std::uint64_t first_ = 0;  ///< the number of the oldest
};

}  // namespace ex9000::sim
