// A defective repeater that sends received bytes again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/virtual_line/bus/bus.hpp"

namespace ex9000::sim {

class Echo final : public Station {
 public:
  /// Attaches itself to `bus`; the echo is off at first. `mode` is the present mode of the line.
  Echo(Bus& bus, SerialMode mode) : bus_(bus), wire_(bus.attach(*this)), mode_(mode) {}
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;

  /// Starts to receive and to send in the mode of the line. The echo sends the received bytes when no byte
  /// has arrived for `delay` and no byte is on the wires.
  void switch_on(VirtualTime delay) {
    on_ = true;
    delay_ = delay;
    wire_.listen(mode_);
  }
  /// Stops listening. The echo still sends the bytes that it has already received.
  void switch_off() {
    on_ = false;
    wire_.listen({});
  }
  /// Sets the rate and format of the line.
  void set_mode(SerialMode mode);
  /// Returns whether the echo has bytes to send or is sending.
  [[nodiscard]] bool sending() const { return next_ != kNever; }

  // --- Station ---
  void run() override;
  void receive(std::uint8_t byte, ByteStatus status) override;

 private:
  /// The maximum number of bytes in one transmission of the echo. Further received bytes are ignored.
  static constexpr std::size_t kMostHeard = 1024;

  Bus& bus_;
  BusEnd& wire_;
  SerialMode mode_;
  bool on_ = false;
  SerialMode sends_in_;  ///< mode of the present transmission, from its first byte to its last
  VirtualTime delay_{0};
  std::vector<std::uint8_t> heard_;
  std::size_t sent_ = 0;  ///< number of bytes of `heard_` sent so far; 0: the driver is off
  VirtualTime began_{0};
  VirtualTime next_ = kNever;

  void wake_at(VirtualTime when);
};

}  // namespace ex9000::sim
