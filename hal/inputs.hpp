#pragma once

#include <cstdint>

namespace ex9000::hal {

/// The input channels. Every edge is handed to `Device::on_edge` in the edge interrupt, with the level read
/// after the edge flag was cleared.
class Inputs {
 public:
  /// From now on edges are told. Returns the levels they start from: bit n is channel n, 1 = logic 1 (+4 to
  /// +30 V). Main loop, once after reset; does not block.
  virtual std::uint16_t start() = 0;

 protected:
  ~Inputs() = default;
};

}  // namespace ex9000::hal
