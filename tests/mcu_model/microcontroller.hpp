// A microcontroller at register level: the target of the drivers' bus accesses on a host. Every access takes
// time, and interrupts occur between accesses.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "tests/mcu_model/chip.hpp"
#include "tests/mcu_model/core.hpp"
#include "tests/mcu_model/gpio_port.hpp"
#include "tests/mcu_model/i2c_block.hpp"
#include "tests/mcu_model/system_control.hpp"
#include "tests/mcu_model/timeline.hpp"
#include "tests/mcu_model/timer_block.hpp"
#include "tests/mcu_model/uart_port.hpp"
#include "tests/mcu_model/watchdog_timer.hpp"

namespace ex9000::registers {

/// The pins of all ports. A reset affects only what the microcontroller drives.
struct Pins {
  Pins() {
    for (unsigned port = 0; port < ports.size(); ++port) {
      for (unsigned pin = 0; pin < ports[port].size(); ++pin) {
        ports[port][pin].on_change([this, port, pin] {
          if (on_change) {
            on_change(port, pin);
          }
        });
      }
    }
  }
  Pins(const Pins&) = delete;
  Pins& operator=(const Pins&) = delete;

  Net& at(char letter, unsigned pin) { return ports.at(static_cast<unsigned>(letter - 'A')).at(pin); }
  /// Returns whether two ends have ever driven a pin to opposite levels at the same time.
  [[nodiscard]] bool any_was_shorted() const {
    return std::any_of(ports.begin(), ports.end(), [](const PortNets& port) {
      return std::any_of(port.begin(), port.end(), [](const Net& net) { return net.was_shorted(); });
    });
  }

  std::array<PortNets, 7> ports;
  std::function<void(unsigned port, unsigned pin)> on_change;  ///< set by the microcontroller
};

struct Access {
  Instant at;
  std::uint32_t address;
  std::uint32_t value;
  bool write;
};

/// Thrown when the microcontroller must be reset.
struct ResetRequest {
  ResetCause cause;
};

/// The part of the firmware that stops.
enum class Hangs : std::uint8_t {
  Nothing,
  MainLoop,  ///< at its next access; interrupts are still served
  Handler,   ///< at the next access in a handler; no interrupt preempts this handler
};

/// An object exists from one reset to the next. The bus accesses of the drivers go to the latest object.
class Microcontroller {
 public:
  Microcontroller(const Chip& chip, Timeline& timeline, Pins& pins, I2cBehaviour behaviour = {});
  ~Microcontroller();
  Microcontroller(const Microcontroller&) = delete;
  Microcontroller& operator=(const Microcontroller&) = delete;

  static Microcontroller& current();

  // --- called by the drivers; all except disable_interrupts can throw Fault or ResetRequest ---

  std::uint32_t read(std::uint32_t address);
  void write(std::uint32_t address, std::uint32_t value);
  void disable_interrupts();
  void enable_interrupts();
  void wait_for_interrupt();

  // --- for tests ---

  /// Lets time pass and serves interrupts, like an idle processor.
  void run_until(Instant when);
  void run_for(Instant time) { run_until(timeline_.now() + time); }

  /// Sets the function that serves each exception; see Core.
  void on_exception(std::function<void(unsigned exception)> act) { core.on_exception(std::move(act)); }
  /// Sets the function that lets time pass until `to`. The function may return before `to`. If `pass` is
  /// null, or if no function is set, Timeline::advance lets time pass.
  void pass_time_by(std::function<void(Instant to)> pass) { pass_ = std::move(pass); }

  /// Sets the number of clock cycles of each access. The default is 2, the minimum of a bus access. The model
  /// does not count the instructions between two accesses. With the default, a delay that consists of
  /// accesses is therefore never longer than on a chip. A greater value makes the simulation faster if the
  /// firmware makes many accesses.
  void set_clocks_an_access(int clocks) { clocks_an_access_ = clocks; }
  [[nodiscard]] std::uint64_t accesses() const { return accesses_; }
  void record(bool on) { recording_ = on; }
  [[nodiscard]] const std::vector<Access>& recorded() const { return recorded_; }
  /// Returns the greatest number of accesses from the time at which interrupts were disabled to the time at
  /// which they were enabled again.
  [[nodiscard]] std::uint64_t most_accesses_held() const { return most_held_; }
  [[nodiscard]] unsigned watchdog_expiries() const { return watchdog_expiries_; }

  /// Stops a part of the firmware until the next reset.
  void hang(Hangs what) { hangs_ = what; }

  GpioPort& port(char letter) { return *ports_.at(static_cast<std::size_t>(letter - 'A')); }
  [[nodiscard]] const Chip& chip() const { return chip_; }

 private:
  const Chip& chip_;
  Timeline& timeline_;
  Pins& pins_;

 public:
  SystemControl system_control;
  Core core;

 private:
  std::vector<std::unique_ptr<GpioPort>> ports_;

 public:
  UartPort uart0;
  UartPort uart1;
  TimerBlock timer0;
  TimerBlock timer1;
  TimerBlock timer2;
  WatchdogTimer watchdog;
  I2cBlock i2c;

 private:
  struct Place {
    Peripheral* peripheral;
    unsigned gate_index;  ///< the number of the word of RCGC; SRCR has the same layout
    unsigned gate_bit;
  };

  Peripheral& peripheral_at(std::uint32_t address);
  void check_usable(const Place& place, std::uint32_t address) const;
  void begin_access(std::uint32_t address, bool write, std::uint32_t value);
  void pass(Instant to);
  void pass_all(Instant to);
  void hang_if_requested();
  void check_reset() const;
  void pin_changed(unsigned port, unsigned pin);

  std::vector<Place> places_;
  std::function<void(Instant)> pass_;
  int clocks_an_access_ = 2;
  Hangs hangs_ = Hangs::Nothing;
  std::optional<ResetCause> reset_requested_;
  unsigned watchdog_expiries_ = 0;
  std::uint64_t accesses_ = 0;
  std::uint64_t held_since_ = 0;
  std::uint64_t most_held_ = 0;
  bool recording_ = false;
  std::vector<Access> recorded_;
};

}  // namespace ex9000::registers
