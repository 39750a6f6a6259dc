// A defective repeater that sends received bytes again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/virtual_line/wires/master.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

class Echo final : public Station {
 public:
  /// Attaches itself to `wires`; the echo is off at first. `mode` is the present mode of the line.
  Echo(Wires& wires, SerialMode mode)
      : wires_(wires),
        end_(wires.attach(*this)),
        repeater_(wires, mode, [this](std::uint8_t byte, ByteStatus /*status*/) { hear(byte); }) {}
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;

  /// The echo sends the received bytes when no byte has arrived for `delay` and no byte is on the wires.
  void switch_on(VirtualTime delay) { delay_ = delay; }
  /// The echo still sends the bytes that it has already received.
  void switch_off() { delay_.reset(); }
  /// Sets the rate and format of the line.
  void set_mode(SerialMode mode) { repeater_.set_mode(mode); }
  /// Returns whether the echo has bytes to send or is sending.
  [[nodiscard]] bool sending() const { return !heard_.empty() || repeater_.sending(); }

  // --- Station ---
  void run() override {
    if (wires_.carries()) {
      // This byte is not in `heard_` yet: it is received after its first stop bit.
      wake_after(repeater_.takes(1));
      return;
    }
    repeater_.send(heard_.data(), heard_.size());
    heard_.clear();
  }

 private:
  /// The maximum number of bytes in one transmission of the echo. Further received bytes are ignored.
  static constexpr std::size_t kMostHeard = 1024;

  void hear(std::uint8_t byte) {
    if (!delay_) {
      return;
    }
    if (heard_.size() < kMostHeard) {
      heard_.push_back(byte);
    }
    wake_after(*delay_);
  }
  void wake_after(VirtualTime time) { end_.run_at(wires_.clock().virtual_now() + time); }

  Wires& wires_;
  WireEnd& end_;
  Master repeater_;
  std::optional<VirtualTime> delay_;  ///< nullopt: off
  std::vector<std::uint8_t> heard_;
};

}  // namespace ex9000::sim
