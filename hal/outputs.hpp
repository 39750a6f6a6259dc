#pragma once

#include <cstdint>

namespace ex9000::hal {

/// The output channels: open collectors, relays or PhotoMOS. From reset until the first `drive` all are
/// de-energised.
class Outputs {
 public:
  /// Bit n is channel n, 1 = energised (the transistor conducts, the relay is pulled); polarity is the
  /// board's. All channels change together, those that stay the same without a glitch. Main loop, every turn;
  /// does not block.
  virtual void drive(std::uint16_t channels) = 0;

 protected:
  ~Outputs() = default;
};

}  // namespace ex9000::hal
