// Passes a module's replies to the wires, and simulates lost replies, late replies and a wrong baud rate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "hal/doubles/serial_line.hpp"
#include "hal/doubles/virtual_clock.hpp"

namespace ex9000::sim {

using hal::SerialMode;
using hal::doubles::kNever;
using hal::doubles::VirtualClock;
using hal::doubles::VirtualTime;
using hal::doubles::Wire;

/// The effect of faults on one reply.
struct ReplyFate {
  bool lost = false;
  VirtualTime late_by{0};
  std::size_t delayed_by = 0;  ///< number of the fault that makes the reply late, from 1; 0: none
};

/// Passes on the bytes that a UART sends. Without a fault, the bytes and their times are unchanged.
class ModuleWire final : public Wire {
 public:
  ModuleWire(const VirtualClock& clock, Wire& wire) : clock_(clock), wire_(wire) {}

  /// Called when the UART enables the driver. `reply` is the number of the reply, from 1. Returns the effect
  /// of faults on the reply. The function must not reset the module or switch off its power.
  using Begins = std::function<ReplyFate(std::uint64_t reply)>;
  /// Called when the UART disables the driver, even if the reply is lost or is not on the wires yet.
  using Ends = std::function<void()>;
  /// Called with `on` true before the driver is enabled on the wires for a reply. Called with `on` false in
  /// three cases: after the driver is disabled on the wires, when `abort` drops the reply, and after Begins
  /// if the reply is lost. `reply` is the same number as for Begins.
  using OnTheWires = std::function<void(std::uint64_t reply, bool on)>;
  void watch(Begins begins, Ends ends, OnTheWires on_the_wires);
  /// Makes the UART run at `baud` regardless of the firmware's setting; 0: the firmware's setting applies.
  void force_rate(std::uint32_t baud) { forced_ = baud; }
  /// Returns `mode`, with the forced rate if there is one and the UART is on.
  [[nodiscard]] SerialMode forced(SerialMode mode) const { return with_rate(forced_, mode); }

  /// Returns whether a late reply is on the wires. The UART may already have sent it completely.
  [[nodiscard]] bool sends_late() const { return driving_late_; }
  [[nodiscard]] VirtualTime next() const { return late_.empty() ? kNever : late_.front().when; }
  void run();
  /// Ends the delay of each waiting reply that `fault` (ReplyFate::delayed_by) makes late. If `fault` is
  /// nullopt, ends the delay of each waiting reply. If the previous reply also waits, the time between the
  /// two replies becomes the same as at the UART. If the previous reply does not wait, the reply begins now
  /// or, if a late reply is on the wires, at the end of that late reply. A reply that has begun on the wires
  /// keeps its delay.
  void end_delays(std::optional<std::size_t> fault);
  /// Drops all bytes that are not on the wires yet, and disables the driver if a late reply is on the wires.
  /// Call this when the module loses its supply or is reset.
  void abort();

  // --- Wire ---
  void drive(bool on) override;
  void put(std::uint8_t byte, SerialMode mode) override;
  [[nodiscard]] VirtualTime takes(std::size_t bytes, SerialMode mode) const override {
    return wire_.takes(bytes, reply_mode(mode));
  }

 private:
  enum class What { On, Byte, Off };
  struct Event {
    VirtualTime sent;  ///< time at which the UART did this
    VirtualTime when;  ///< time at which it happens on the wires
    What what;
    std::uint8_t byte;
    SerialMode mode;
    std::uint64_t reply;
    ReplyFate fate;
  };

  /// A reply is lost if `late_` has more entries than this when the reply begins, so that endless requests
  /// cannot fill the computer's memory.
  static constexpr std::size_t kMostLate = 65'536;

  void hand_on(What what, std::uint8_t byte, SerialMode mode);
  void carry_out(const Event& event);
  [[nodiscard]] SerialMode reply_mode(SerialMode mode) const {
    return with_rate(drives_ ? forced_for_reply_ : forced_, mode);
  }
  static SerialMode with_rate(std::uint32_t baud, SerialMode mode) {
    return baud != 0 && mode.baud != 0 ? SerialMode{baud, mode.format} : mode;
  }

  const VirtualClock& clock_;
  Wire& wire_;
  Begins begins_ = [](std::uint64_t /*reply*/) { return ReplyFate(); };
  Ends ends_ = [] {};
  OnTheWires on_the_wires_ = [](std::uint64_t /*reply*/, bool /*on*/) {};
  ReplyFate fate_;
  /// The delay of the reply that the UART sends. May differ from `fate_.late_by`: the delay is longer if the
  /// reply must wait for the end of a late one, and `end_delays` may shorten it.
  VirtualTime delay_{0};
  std::uint64_t reply_ = 0;  ///< number of the reply that the UART sends, or has sent last
  std::uint32_t forced_ = 0;
  std::uint32_t forced_for_reply_ = 0;  ///< the forced rate for the whole reply
  bool drives_ = false;                 ///< the UART has enabled its driver
  std::deque<Event> late_;              ///< the events that are not on the wires yet
  bool driving_late_ = false;
};

}  // namespace ex9000::sim
