#pragma once

#include <functional>
#include <utility>

namespace ex9000::hal::doubles {

class StatusLed {
 public:
  void light(bool on) {
    if (on != lit_) {
      lit_ = on;
      if (on_change_) {
        on_change_(on);
      }
    }
  }

  [[nodiscard]] bool lit() const { return lit_; }
  void on_change(std::function<void(bool)> observer) { on_change_ = std::move(observer); }

 private:
  bool lit_ = false;
  std::function<void(bool)> on_change_;
};

}  // namespace ex9000::hal::doubles
