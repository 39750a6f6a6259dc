#pragma once

#include "hal/init_switch.hpp"

namespace ex9000::hal::doubles {

class InitSwitch {
 public:
  [[nodiscard]] bool asserted() const { return asserted_; }
  void set(bool asserted) { asserted_ = asserted; }

 private:
  bool asserted_ = false;
};
static_assert(kIsInitSwitch<InitSwitch>);

}  // namespace ex9000::hal::doubles
