#pragma once

#include "hal/init_switch.hpp"

namespace ex9000::hal::doubles {

class InitSwitch final : public hal::InitSwitch {
 public:
  [[nodiscard]] bool asserted() const override { return asserted_; }
  void set(bool asserted) { asserted_ = asserted; }

 private:
  bool asserted_ = false;
};

}  // namespace ex9000::hal::doubles
