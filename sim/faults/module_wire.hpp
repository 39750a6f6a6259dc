// A module's way to the wires, and what may be wrong with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>

#include "hal/doubles/serial_line.hpp"
#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualClock;
using hal::doubles::VirtualTime;
using hal::doubles::Wire;

/// What becomes of a reply.
struct ReplyFate {
  bool lost = false;
  VirtualTime late_by{0};
};

/// Hands on what a UART sends: as it is, unless it has been told otherwise.
class ModuleWire final : public Wire {
 public:
  ModuleWire(const VirtualClock& clock, Wire& wire) : clock_(clock), wire_(wire) {}

  /// Asked as the driver goes on. It must not take the module's power.
  using Begins = std::function<ReplyFate()>;
  /// Called as it goes off, wherever the reply is then.
  using Ends = std::function<void()>;
  /// Called before the reply goes on the wires and behind its end there, or where it never gets there: which,
  /// counted from 1 as they begin, the lost ones too, of which it is not called.
  using OnTheWires = std::function<void(std::uint64_t reply, bool on)>;
  void watch(Begins begins, Ends ends, OnTheWires on_the_wires);
  /// The UART runs at `baud` whatever it was told; 0: as it was told.
  void force_rate(std::uint32_t baud) { forced_ = baud; }
  [[nodiscard]] std::uint32_t rate(std::uint32_t baud) const {
    return forced_ != 0 && baud != 0 ? forced_ : baud;
  }

  /// A reply that is late is on its way, while the UART is done with it.
  [[nodiscard]] bool sends_late() const { return driving_late_; }
  [[nodiscard]] VirtualTime next() const { return late_.empty() ? kNever : late_.front().when; }
  void run();
  /// The first reply that waits to be late need not wait any more; those behind it follow as they would have.
  void hurry();
  /// The supply is off: what has not been sent never will be.
  void abort();

  // --- Wire ---
  void drive(bool on) override;
  void put(std::uint8_t byte, std::uint32_t baud) override;
  [[nodiscard]] VirtualTime takes(std::size_t bytes, std::uint32_t baud) const override {
    return wire_.takes(bytes, reply_rate(baud));
  }

 private:
  enum class What { On, Byte, Off };
  struct Late {
    VirtualTime when;
    What what;
    std::uint8_t byte;
    std::uint32_t baud;
    std::uint64_t reply;
  };

  /// Beyond that replies get lost: whoever asks on and on is not to be remembered for good.
  static constexpr std::size_t kMostLate = 65'536;

  void hand_on(What what, std::uint8_t byte, std::uint32_t baud);
  void carry_out(const Late& due);
  void tell(std::uint64_t reply, bool on) const;
  [[nodiscard]] std::uint32_t reply_rate(std::uint32_t baud) const {
    if (!drives_) {
      return rate(baud);
    }
    return forced_for_reply_ != 0 ? forced_for_reply_ : baud;
  }

  const VirtualClock& clock_;
  Wire& wire_;
  Begins begins_;
  Ends ends_;
  OnTheWires on_the_wires_;
  ReplyFate fate_;
  std::uint64_t reply_ = 0;  ///< which the UART sends, or has sent last
  std::uint32_t forced_ = 0;
  std::uint32_t forced_for_reply_ = 0;  ///< for the whole of it
  bool drives_ = false;                 ///< the UART does
  std::deque<Late> late_;
  bool driving_late_ = false;
};

}  // namespace ex9000::sim
