// A repeater out of order: it sends again whatever it has heard.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/bus.hpp"

namespace ex9000::sim {

class Echo final : public Station {
 public:
  /// Attaches itself to `bus`; it is off.
  explicit Echo(Bus& bus) : clock_(bus.clock()), wire_(bus.attach(*this)) {}
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;

  /// It listens and sends at `baud`, and sends when nothing has come for `delay`.
  void switch_on(std::uint32_t baud, VirtualTime delay) {
    baud_ = rate_ = baud;
    delay_ = delay;
  }
  /// It listens no more; what it has heard it still sends.
  void switch_off() { baud_ = 0; }

  // --- Station ---
  [[nodiscard]] VirtualTime next() const override { return next_; }
  void run() override;
  [[nodiscard]] std::uint32_t baud() const override { return baud_; }
  void receive(std::uint8_t byte, ByteStatus status) override;

 private:
  VirtualClock& clock_;
  Wire& wire_;
  std::uint32_t baud_ = 0;  ///< 0: it does not listen
  std::uint32_t rate_ = 0;
  VirtualTime delay_{0};
  std::vector<std::uint8_t> heard_;
  std::size_t sent_ = 0;
  bool driving_ = false;
  VirtualTime began_{0};
  VirtualTime next_ = kNever;
};

}  // namespace ex9000::sim
