#pragma once

namespace ex9000::hal {

class StatusLed {
 public:
  /// Main loop, every turn; does not block.
  virtual void light(bool on) = 0;

 protected:
  ~StatusLed() = default;
};

}  // namespace ex9000::hal
