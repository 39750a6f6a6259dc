#pragma once

#include <cstdint>

namespace ex9000::hal::doubles {

class Inputs {
 public:
  std::uint16_t start() { return levels_; }
  [[nodiscard]] std::uint16_t levels() const { return levels_; }
  [[nodiscard]] bool level(unsigned channel) const { return (levels_ >> channel & 1U) != 0; }

  /// Whether the level changes. If the module is powered, the caller must then call `Device::on_edge`.
  bool set(unsigned channel, bool level) {
    const auto bit = static_cast<std::uint16_t>(1U << channel);
    const std::uint16_t before = levels_;
    levels_ = static_cast<std::uint16_t>(level ? levels_ | bit : levels_ & ~bit);
    return levels_ != before;
  }

 private:
  std::uint16_t levels_ = 0;
};

}  // namespace ex9000::hal::doubles
