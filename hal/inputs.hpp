#pragma once

#include <cstdint>

namespace ex9000::hal {

/// The input channels. Every edge is handed to `Device::on_edge` in the edge interrupt, with the level read
/// after the edge flag was cleared.
class Inputs {
 public:
  /// Bit n is channel n, 1 = logic 1 (+4 to +30 V). Interrupts and main loop; does not block.
  [[nodiscard]] virtual std::uint16_t levels() const = 0;

 protected:
  ~Inputs() = default;
};

}  // namespace ex9000::hal
