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
  /// Off at first. `mode`: the line's present one.
  Echo(Wires& wires, SerialMode mode)
      : wires_(wires),
        end_(wires.attach(*this)),
        repeater_(wires, mode, [this](std::uint8_t byte, ByteStatus /*status*/) { hear(byte); }) {}
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;

  /// Repeats what it has heard once no byte has arrived for `delay` and none is on the wires.
  void switch_on(VirtualTime delay) { delay_ = delay; }
  /// Bytes already heard are still sent.
  void switch_off() { delay_.reset(); }
  void set_mode(SerialMode mode) { repeater_.set_mode(mode); }
  [[nodiscard]] bool sending() const { return !heard_.empty() || repeater_.sending(); }

  void run() override {
    if (wires_.carries()) {
      // The byte on the wires is not in `heard_` yet: it arrives after its first stop bit.
      wake_after(repeater_.takes(1));
      return;
    }
    repeater_.send(heard_.data(), heard_.size());
    heard_.clear();
  }

 private:
  /// In one transmission; further bytes are ignored.
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
