// A value that viewers get again only after it has changed.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace ex9000::sim {

/// A value, and the number of the look at which it last changed. A look captures the present state for all
/// viewers.
template <class Value>
class ChangeTracked {
 public:
  /// Stores `value`. `look` is the number of the present look, from 1. The first value counts as a change.
  void set(Value value, std::uint64_t look) {
    if (!value_ || !(*value_ == value)) {
      value_ = std::move(value);
      changed_ = look;
    }
  }
  /// Returns the value if it has changed after look number `look`, otherwise null.
  [[nodiscard]] const Value* news_since(std::uint64_t look) const {
    return changed_ > look ? &*value_ : nullptr;
  }

 private:
  std::optional<Value> value_;
  std::uint64_t changed_ = 0;
};

}  // namespace ex9000::sim
