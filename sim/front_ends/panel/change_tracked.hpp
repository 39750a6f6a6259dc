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
  /// Returns whether the value has changed after look number `look`.
  [[nodiscard]] bool has_changed_since(std::uint64_t look) const { return changed_ > look; }
  [[nodiscard]] const Value& value() const { return *value_; }

 private:
  std::optional<Value> value_;
  std::uint64_t changed_ = 0;
};

}  // namespace ex9000::sim
