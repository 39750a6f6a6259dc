// A repeater out of order: it sends again whatever it has heard.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "sim/bus.hpp"

namespace ex9000::sim {

class Echo final : public Station {
 public:
  /// Asked for the rate, in baud, that the line has now.
  using Rate = std::function<std::uint32_t()>;

  /// Attaches itself to `bus`; it is off.
  Echo(Bus& bus, Rate rate)
      : bus_(bus), clock_(bus.clock()), wire_(bus.attach(*this)), rate_(std::move(rate)) {}
  Echo(const Echo&) = delete;
  Echo& operator=(const Echo&) = delete;

  /// It listens and sends at the line's rate, and sends when nothing has come for `delay`.
  void switch_on(VirtualTime delay) {
    on_ = true;
    delay_ = delay;
  }
  /// It listens no more; what it has heard it still sends.
  void switch_off() { on_ = false; }

  // --- Station ---
  [[nodiscard]] VirtualTime next() const override { return next_; }
  void run() override;
  [[nodiscard]] std::uint32_t baud() const override { return on_ ? rate_() : 0; }
  void receive(std::uint8_t byte, ByteStatus status) override;

 private:
  static constexpr std::size_t kMostHeard = 1024;  ///< beyond that it forgets: a line carries what it can

  const Bus& bus_;
  VirtualClock& clock_;
  Wire& wire_;
  Rate rate_;
  bool on_ = false;
  std::uint32_t sends_at_ = 0;  ///< what it sends now, from its first byte to its last
  VirtualTime delay_{0};
  std::vector<std::uint8_t> heard_;
  std::size_t sent_ = 0;
  bool driving_ = false;
  VirtualTime began_{0};
  VirtualTime next_ = kNever;
};

}  // namespace ex9000::sim
