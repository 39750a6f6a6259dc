// Records the complete bytes on a virtual line, and the times at which stations enable or disable their
// drivers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

class WiresRecorder final : public WireObserver {
 public:
  struct Byte {
    std::size_t station;
    std::uint8_t byte;
    bool collided;
    VirtualTime start;
    VirtualTime end;
  };
  struct Driver {
    std::size_t station;
    bool on;
    VirtualTime at;
  };

  void driver(std::size_t station, bool on, VirtualTime now) override {
    drivers.push_back({station, on, now});
  }
  void byte(std::size_t station, std::uint8_t byte, SerialMode /*mode*/, bool collided, VirtualTime start,
            VirtualTime end) override {
    bytes.push_back({station, byte, collided, start, end});
  }

  /// Returns the recorded bytes that `station` has sent, in order.
  [[nodiscard]] std::vector<std::uint8_t> sent_by(std::size_t station) const {
    std::vector<std::uint8_t> sent;
    for (const Byte& each : bytes) {
      if (each.station == station) {
        sent.push_back(each.byte);
      }
    }
    return sent;
  }
  void clear() {
    bytes.clear();
    drivers.clear();
  }

  std::vector<Byte> bytes;
  std::vector<Driver> drivers;
};

}  // namespace ex9000::sim
