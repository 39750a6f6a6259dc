#pragma once

namespace ex9000::hal {

/// The INIT* pin, active low. Where a jumper has given the pin to another signal it reads released.
class InitSwitch {
 public:
  /// INIT* is tied to GND at this moment; bounces and all. Main loop; does not block.
  [[nodiscard]] virtual bool asserted() const = 0;

 protected:
  ~InitSwitch() = default;
};

}  // namespace ex9000::hal
