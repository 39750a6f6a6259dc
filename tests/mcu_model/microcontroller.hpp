// A microcontroller by its registers: what the drivers' bus accesses lead to on a host. Every access takes
// its time, and interrupts come between accesses.
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

/// The pins of all ports; they outlast a reset.
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
  /// On any of them two ends have driven hard against each other, ever.
  [[nodiscard]] bool any_was_shorted() const {
    return std::any_of(ports.begin(), ports.end(), [](const PortNets& port) {
      return std::any_of(port.begin(), port.end(), [](const Net& net) { return net.was_shorted(); });
    });
  }

  std::array<PortNets, 7> ports;
  std::function<void(unsigned port, unsigned pin)> on_change;  ///< the microcontroller's
};

struct Access {
  Instant at;
  std::uint32_t address;
  std::uint32_t value;
  bool write;
};

/// How it came to begin anew.
class ResetRequest {};

/// What does not go on any more.
enum class Hangs : std::uint8_t {
  Nothing,
  MainLoop,  ///< from its next access on; interrupts are served
  Handler,   ///< the next one that is served, from its next access on; none interrupts it
};

/// From one reset to the next. The drivers' bus leads to the one that was made last.
class Microcontroller {
 public:
  Microcontroller(const Chip& chip, Timeline& timeline, Pins& pins, I2cManners manners = {});
  ~Microcontroller();
  Microcontroller(const Microcontroller&) = delete;
  Microcontroller& operator=(const Microcontroller&) = delete;

  static Microcontroller& current();

  // --- what the drivers do; throws Fault, and ResetRequest ---

  std::uint32_t read(std::uint32_t address);
  void write(std::uint32_t address, std::uint32_t value);
  void hold_interrupts();
  void release_interrupts();
  void wait_for_interrupt();

  // --- for tests ---

  /// Lets time pass and interrupts be served, as a processor with nothing else to do.
  void run_until(Instant when);
  void run_for(Instant time) { run_until(timeline_.now() + time); }

  /// What serves `exception`; see Core.
  void on_exception(std::function<void(unsigned exception)> act) { core.on_exception(std::move(act)); }
  /// How time passes up to a point, or less far; else Timeline::advance.
  void pass_time_by(std::function<void(Instant to)> pass) { pass_ = std::move(pass); }

  /// The least that an access over the bus takes, in clocks, is 2; what comes between two is not counted, so
  /// that delays which are made of accesses are judged at their shortest. More makes long waits cheap to run.
  void set_clocks_an_access(int clocks) { clocks_an_access_ = clocks; }
  [[nodiscard]] std::uint64_t accesses() const { return accesses_; }
  void record(bool on) { recording_ = on; }
  [[nodiscard]] const std::vector<Access>& recorded() const { return recorded_; }
  /// Most accesses made between one hold of interrupts and the release.
  [[nodiscard]] std::uint64_t most_accesses_held() const { return most_held_; }
  [[nodiscard]] unsigned watchdog_bites() const { return bites_; }
  /// Told before each write has its effect.
  void on_write(std::function<void(std::uint32_t address, std::uint32_t value)> act) {
    on_write_ = std::move(act);
  }

  /// Until the next reset.
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
    unsigned gate_index;  ///< of RCGC, and of SRCR, whose bits are the same
    unsigned gate_bit;
  };

  Peripheral& peripheral_at(std::uint32_t address);
  void check_usable(const Place& place, std::uint32_t address) const;
  void begin_access(std::uint32_t address, bool write, std::uint32_t value);
  void pass(Instant to);
  void pass_all(Instant to);
  void hang_if_told();
  void check_reset() const;
  void pin_changed(unsigned port, unsigned pin);

  std::vector<Place> places_;
  std::function<void(Instant)> pass_;
  std::function<void(std::uint32_t, std::uint32_t)> on_write_;
  int clocks_an_access_ = 2;
  Hangs hangs_ = Hangs::Nothing;
  bool reset_requested_ = false;
  unsigned bites_ = 0;
  std::uint64_t accesses_ = 0;
  std::uint64_t held_since_ = 0;
  std::uint64_t most_held_ = 0;
  bool recording_ = false;
  std::vector<Access> recorded_;
};

}  // namespace ex9000::registers
