// A model of the microcontroller (a UART with its RS-485 driver, three timers, a tick, a clock and a
// watchdog) and of the other hardware of a module, for example the memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "hal/registers/bus.hpp"
#include "hal/stellaris/gpio.hpp"

namespace ex9000::interleaving {

inline constexpr hal::stellaris::Pin kDriverEnable{hal::stellaris::Port::A, 6};

/// The bytes that were sent while the driver was on.
struct Sent {
  std::uint32_t started;  ///< when the driver was switched on, in microseconds
  std::uint32_t ended;    ///< when the last stop bit ended
  std::string bytes;
};

/// Simulates only the hardware. Each member `..._due` is the time of the next event of one kind, or `kNever`
/// if no such event is due. At `sent_due`, the owner must call `shift`. At the time of any other event, the
/// owner must set the member to `kNever` or to the time of the next event of this kind, and then call the
/// interrupt handler. At `tick_due`, the owner must also increment `ticks`. While `interrupts()` is true, the
/// owner must call the interrupt handler of the UART.
class Chip final : public hal::bus::Peripherals {
 public:
  static constexpr std::uint32_t kNever = 0xFFFF'FFFF;
  static constexpr std::uint32_t kCharacter = 87;  ///< microseconds for each character at 115200 baud
  static constexpr std::uint32_t kMemoryJob = 3000;

  /// The clock begins at 50 minutes, in the second half of its 32-bit range. The initial value 0 of a time
  /// is therefore in the future, not in the past.
  std::uint32_t now = 3'000'000'000;
  std::uint32_t tick_due = now + 1000;
  std::uint32_t silence_due = kNever;
  std::uint32_t line_end_due = kNever;
  std::uint32_t wake_due = kNever;
  std::uint32_t memory_due = kNever;
  std::uint32_t sent_due = kNever;  ///< when the byte in the shift register has been sent

  std::vector<Sent> sent;
  std::uint16_t outputs = 0;
  unsigned ticks = 0;
  unsigned feeds = 0;  ///< the number of times that the watchdog was fed

  [[nodiscard]] std::uint32_t next() const {
    return std::min({tick_due, silence_due, line_end_due, wake_due, memory_due, sent_due});
  }

  // --- the UART; the code in hal/pl011/uart.hpp accesses its registers ---

  [[nodiscard]] bool driving() const { return driving_; }
  /// Returns whether a received byte causes an interrupt.
  [[nodiscard]] bool hears() const { return (enabled_ & kReceive) != 0; }
  void receive(std::uint8_t byte) {
    received_ = byte;
    flagged_ |= kReceive;
  }
  /// Ends the transmission of the byte in the shift register. If another byte waits, its transmission begins.
  void shift() {
    sent.back().bytes.push_back(static_cast<char>(shifting_));
    sent.back().ended = now;
    sent_due = kNever;
    if (holding_ >= 0) {
      begin_shifting(static_cast<std::uint8_t>(holding_));
      holding_ = -1;
    }
  }
  [[nodiscard]] bool interrupts() const { return (flagged_ & enabled_) != 0; }

  std::uint32_t read(std::uint32_t address) override {
    switch (address) {
      case kUart + 0x000:
        flagged_ &= ~kReceive;
        return static_cast<std::uint32_t>(std::exchange(received_, -1));
      case kUart + 0x018:
        return (received_ < 0 ? 1U << 4U : 0) | (sent_due != kNever ? 1U << 3U : 0);
      case kUart + 0x040:
        return flagged_ & enabled_;
      default:
        return 0;
    }
  }
  void write(std::uint32_t address, std::uint32_t value) override {
    switch (address) {
      case kUart + 0x000:
        put(static_cast<std::uint8_t>(value));
        break;
      case kUart + 0x038:
        enabled_ = value;
        break;
      case kUart + 0x044:
        flagged_ &= ~value;
        break;
      case kPortA + (1U << kDriverEnable.number << 2U):
        drive(value != 0);
        break;
      default:
        break;
    }
  }

 private:
  static constexpr std::uint32_t kUart = 0x4000'C000;
  static constexpr std::uint32_t kPortA = 0x4000'4000;
  static constexpr std::uint32_t kReceive = 1U << 4U;
  static constexpr std::uint32_t kTransmit = 1U << 5U;

  void put(std::uint8_t byte) {
    if (!driving_) {
      throw std::logic_error("a byte is sent while the driver is off");
    }
    if (sent_due == kNever) {
      begin_shifting(byte);
    } else if (holding_ < 0) {
      holding_ = byte;
    } else {
      throw std::logic_error("a byte is written while another byte waits");
    }
  }
  void begin_shifting(std::uint8_t byte) {
    shifting_ = byte;
    sent_due = now + kCharacter;
    flagged_ |= kTransmit;
  }
  void drive(bool on) {
    if (on == driving_) {
      throw std::logic_error("the driver already has this state");
    }
    if (on) {
      sent.push_back({now, kNever, ""});
    } else if (sent_due != kNever || sent.back().bytes.empty()) {
      throw std::logic_error("the driver is switched off during a byte, or before the first byte");
    }
    driving_ = on;
  }

  std::uint32_t enabled_ = 0;
  std::uint32_t flagged_ = 0;
  std::int32_t received_ = -1;
  std::uint8_t shifting_ = 0;
  std::int32_t holding_ = -1;
  bool driving_ = false;
};

/// The chip that the following classes use.
inline Chip* chip = nullptr;

struct Clock {
  [[nodiscard]] static Time now() {
    Points::pass();
    const Time time(chip->now);
    Points::pass();
    return time;
  }
  [[nodiscard]] static Time now_in_interrupt() { return Time(chip->now); }
};

struct SilenceTimer {
  static void restart(Duration after) { chip->silence_due = chip->now + after.microseconds(); }
};
struct LineEndTimer {
  static void restart(Duration after) { chip->line_end_due = chip->now + after.microseconds(); }
};

/// Only the main loop restarts this timer, so an interrupt can occur before and after a restart.
struct WakeTimer {
  static void restart(Duration after) {
    Points::pass();
    chip->wake_due = chip->now + after.microseconds();
    Points::pass();
  }
};

struct Inputs {
  [[nodiscard]] static std::uint16_t start() { return 0; }
};
struct Outputs {
  static void drive(std::uint16_t channels) {
    Points::pass();
    chip->outputs = channels;
    Points::pass();
  }
};
struct InitSwitch {
  [[nodiscard]] static bool asserted() { return false; }
};
struct StatusLed {
  static void light(bool /*on*/) {}
};

struct Watchdog {
  static void restart() { throw std::logic_error("no update is under way"); }
  static void feed() {
    // The watchdog is fed once at reset, and then at most once for each tick.
    if (chip->feeds++ > chip->ticks) {
      throw std::logic_error("the watchdog is fed more often than the tick allows");
    }
  }
};

/// An EEPROM. A read or a write ends after `kMemoryJob` microseconds, with an interrupt.
class Memory {
 public:
  static constexpr std::size_t kSize = 0x100;

  void start_read(std::uint16_t address, MutableBytes destination, Time /*now*/) {
    Points::pass();
    std::copy_n(contents.begin() + address, destination.size, destination.data);
    source_ = {};
    begin();
  }
  /// Starts a write. `poll` reads the bytes of `source` later, so they must not change before that.
  void start_write(std::uint16_t address, Bytes source, Time /*now*/) {
    Points::pass();
    address_ = address;
    source_ = source;
    begin();
  }
  bool poll(Time /*now*/) {
    std::copy(source_.begin(), source_.end(), contents.begin() + address_);
    source_ = {};
    return false;
  }
  [[nodiscard]] static bool busy() {
    Points::pass();
    return chip->memory_due != Chip::kNever;
  }
  [[nodiscard]] static bool succeeded() { return true; }

  std::vector<std::uint8_t> contents = std::vector<std::uint8_t>(kSize, 0xFF);

 private:
  std::uint16_t address_ = 0;
  Bytes source_;

  static void begin() {
    chip->memory_due = chip->now + Chip::kMemoryJob;
    Points::pass();
  }
};

}  // namespace ex9000::interleaving
