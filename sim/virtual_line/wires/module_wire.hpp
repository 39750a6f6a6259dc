// Between a module's UART and the wires: lost, late and changed replies, and a wrong baud rate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "hal/doubles/serial_line.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

using hal::SerialMode;
using hal::doubles::kNever;
using hal::doubles::VirtualClock;
using hal::doubles::VirtualTime;
using hal::doubles::Wire;

/// A reply that the UART is about to send. Faults change it.
struct Reply {
  std::vector<std::uint8_t> bytes;  ///< at least one
  bool lost = false;
  VirtualTime late_by{0};
  std::size_t delayed_by = 0;  ///< number of the fault that makes the reply late, from 1; 0: none
};

/// Without a fault, the bytes and their times are unchanged.
class ModuleWire final : public Wire {
 public:
  ModuleWire(const VirtualClock& clock, WireEnd& wire) : clock_(clock), wire_(wire) {}

  /// Before the UART enables its driver. May change the reply, but not reset the module or cut its supply.
  /// Not for the bytes FF of an arbitration, which are no replies.
  using Begins = std::function<void(Reply& reply)>;
  /// When the UART disables its driver, even if the reply is lost or is not on the wires yet.
  using Ends = std::function<void()>;
  void watch(Begins begins, Ends ends) {
    begins_ = std::move(begins);
    ends_ = std::move(ends);
  }
  /// Overrides the firmware's rate; 0: no longer.
  void force_rate(std::uint32_t baud) { forced_ = baud; }
  /// `mode` at the forced rate, if there is one and the UART is on.
  [[nodiscard]] SerialMode forced(SerialMode mode) const { return with_rate(forced_, mode); }

  /// A late reply is on the wires; the UART may be done with it.
  [[nodiscard]] bool sends_late() const { return driving_late_; }
  [[nodiscard]] VirtualTime next() const { return late_.empty() ? kNever : late_.front().when; }
  void run();
  /// Ends the delay of each waiting reply that `fault` (Reply::delayed_by) makes late. Behind another waiting
  /// reply, it keeps the UART's distance; else it begins now, or after the late reply on the wires. A reply
  /// that has begun on the wires keeps its delay.
  void end_delays(std::size_t fault);
  /// At a reset or loss of supply: drops what is not on the wires yet; a late reply's driver goes off.
  void abort();

  std::optional<Character> next_byte();

  Bytes replaced(Bytes bytes) override;
  void drive(bool on) override;
  [[nodiscard]] bool low() const override { return wire_.low(); }
  void put(Bytes bytes, SerialMode mode) override;
  [[nodiscard]] VirtualTime takes(std::size_t bytes, SerialMode mode) const override {
    return wire_.takes(bytes, reply_mode(mode));
  }

 private:
  enum class What { On, Reply, Off };
  struct Event {
    VirtualTime sent;  ///< time at which the UART did this
    VirtualTime when;  ///< time at which it happens on the wires
    What what;
    std::vector<std::uint8_t> bytes;
    SerialMode mode;
    VirtualTime late_by;
    std::size_t delayed_by;
  };

  /// With more entries in `late_`, a new reply is lost: endless requests must not fill the memory.
  static constexpr std::size_t kMostLate = 65'536;

  void hand_on(What what, std::vector<std::uint8_t> bytes, SerialMode mode);
  void carry_out(Event event);
  [[nodiscard]] SerialMode reply_mode(SerialMode mode) const {
    return with_rate(drives_ ? forced_for_reply_ : forced_, mode);
  }
  static SerialMode with_rate(std::uint32_t baud, SerialMode mode) {
    return baud != 0 && mode.baud != 0 ? SerialMode{baud, mode.format} : mode;
  }

  const VirtualClock& clock_;
  WireEnd& wire_;
  Begins begins_;
  Ends ends_;
  Reply reply_;  ///< what the UART sends, if `begins_` is not null
  bool is_reply_ = true;
  /// Of the reply at the UART: longer than its `late_by` behind a late reply; `end_delays` may shorten it.
  VirtualTime delay_{0};
  std::uint32_t forced_ = 0;
  std::uint32_t forced_for_reply_ = 0;  ///< the forced rate for the whole reply
  bool drives_ = false;                 ///< the UART has enabled its driver
  std::deque<Event> late_;              ///< the events that are not on the wires yet
  bool driving_late_ = false;
  std::vector<std::uint8_t> on_wires_;  ///< the reply that is on the wires
  std::size_t sent_ = 0;                ///< number of its bytes that have begun
  SerialMode mode_;
};

}  // namespace ex9000::sim
