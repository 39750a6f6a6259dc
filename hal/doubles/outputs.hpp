#pragma once

#include <cstdint>
#include <functional>
#include <utility>

namespace ex9000::hal::doubles {

class Outputs {
 public:
  void drive(std::uint16_t channels) {
    if (channels != channels_) {
      channels_ = channels;
      if (on_change_) {
        on_change_(channels);
      }
    }
  }

  [[nodiscard]] std::uint16_t channels() const { return channels_; }
  void on_change(std::function<void(std::uint16_t)> observer) { on_change_ = std::move(observer); }

 private:
  std::uint16_t channels_ = 0;
  std::function<void(std::uint16_t)> on_change_;
};

}  // namespace ex9000::hal::doubles
