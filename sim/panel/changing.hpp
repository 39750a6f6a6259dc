// What is told of when it has changed.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

namespace ex9000::sim {

/// A value, and when it was last another.
template <class Value>
class Changing {
 public:
  /// `look`: the number of the present one.
  void set(Value value, std::uint64_t look) {
    if (!value_ || !(*value_ == value)) {
      value_ = std::move(value);
      changed_ = look;
    }
  }
  /// Whether somebody who was told of look number `told` knows an older value.
  [[nodiscard]] bool is_news_since(std::uint64_t told) const { return changed_ > told; }
  [[nodiscard]] const Value& value() const { return *value_; }

 private:
  std::optional<Value> value_;
  std::uint64_t changed_ = 0;
};

}  // namespace ex9000::sim
