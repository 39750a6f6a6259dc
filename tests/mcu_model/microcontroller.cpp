#include "tests/mcu_model/microcontroller.hpp"

#include <algorithm>
#include <cassert>

#include "hal/cortex_m/processor.hpp"
#include "hal/registers/bus.hpp"

namespace ex9000::registers {

namespace {

Microcontroller* current_one = nullptr;

UartPort::Pins pins_of_uart(const Chip& chip, unsigned number,
                            std::vector<std::unique_ptr<GpioPort>>& ports) {
  if (number == 0) {
    return {ports.at(0).get(), 0, 1, 1};
  }
  return chip.port_control ? UartPort::Pins{ports.at(2).get(), 4, 5, 2}
                           : UartPort::Pins{ports.at(3).get(), 2, 3, 0};
}

std::vector<std::unique_ptr<GpioPort>> make_ports(const Chip& chip, Pins& pins) {
  std::vector<std::unique_ptr<GpioPort>> ports;
  for (unsigned i = 0; i < chip.ports; ++i) {
    ports.push_back(std::make_unique<GpioPort>(chip, static_cast<char>('A' + i), pins.ports.at(i)));
  }
  return ports;
}

}  // namespace

Microcontroller::Microcontroller(const Chip& chip, Timeline& timeline, Pins& pins, I2cBehaviour behaviour)
    : chip_(chip),
      timeline_(timeline),
      pins_(pins),
      system_control(chip, timeline),
      core(system_control, timeline),
      ports_(make_ports(chip, pins)),
      uart0(0, system_control, timeline, pins_of_uart(chip, 0, ports_)),
      uart1(1, system_control, timeline, pins_of_uart(chip, 1, ports_)),
      timer0(0, system_control, timeline),
      timer1(1, system_control, timeline),
      timer2(2, system_control, timeline),
      watchdog(system_control, timeline,
               [this] {
                 ++watchdog_expiries_;
                 reset_requested_ = ResetCause::Watchdog;
               }),
      i2c(chip, system_control, timeline, port('B'), pins.ports.at(1), behaviour) {
  for (unsigned i = 0; i < chip.ports; ++i) {
    places_.push_back({ports_[i].get(), 2, i});
  }
  places_.insert(places_.end(), {{&uart0, 1, 0},
                                 {&uart1, 1, 1},
                                 {&i2c, 1, 12},
                                 {&timer0, 1, 16},
                                 {&timer1, 1, 17},
                                 {&timer2, 1, 18},
                                 {&watchdog, 0, 3}});
  const auto leads_to = [this](Peripheral& peripheral, unsigned interrupt) {
    peripheral.on_interrupt_line([this, interrupt](bool on) { core.interrupt_line_of(interrupt, on); });
  };
  for (unsigned i = 0; i < ports_.size(); ++i) {
    leads_to(*ports_[i], i < 5 ? i : i + 25);  // 0 to 4 for ports A to E, 30 and 31 for F and G
  }
  leads_to(uart0, 5);
  leads_to(uart1, 6);
  leads_to(i2c, 8);
  leads_to(watchdog, 18);
  leads_to(timer0, 19);
  leads_to(timer1, 21);
  leads_to(timer2, 23);
  system_control.on_standstill([this](Instant until) { pass_all(until); });
  system_control.on_software_reset([this](unsigned index, unsigned bit) {
    if (index != 1 || bit != 12) {
      throw Fault(SystemControl::kBase + SystemControl::kSrcr + 4 * index,
                  "the simulation does not support a software reset of this peripheral");
    }
    i2c.software_reset();
  });
  core.on_reset_request([this] { reset_requested_ = ResetCause::Software; });
  pins.on_change = [this](unsigned changed_port, unsigned pin) { pin_changed(changed_port, pin); };
  current_one = this;
}

Microcontroller::~Microcontroller() {
  pins_.on_change = nullptr;
  if (current_one == this) {
    current_one = nullptr;
  }
}

void Microcontroller::pin_changed(unsigned port, unsigned pin) {
  if (port >= chip_.ports) {
    return;
  }
  ports_[port]->look_at(pin);
  const bool level = pins_.ports[port][pin].level();
  for (UartPort* uart : {&uart0, &uart1}) {
    if (uart->receives_on(*ports_[port], pin)) {
      uart->receive_level(level);
    }
  }
  if (ports_[port].get() == &this->port('B') && pin == I2cBlock::kClockPin) {
    i2c.look_at_clock();
  }
}

Microcontroller& Microcontroller::current() {
  assert(current_one != nullptr);
  return *current_one;
}

Peripheral& Microcontroller::peripheral_at(std::uint32_t address) {
  if (address % 4 != 0) {
    throw Fault(address, "the address is not a multiple of 4");
  }
  const std::uint32_t base = address & ~0xFFFU;
  if (base == SystemControl::kBase) {
    return system_control;
  }
  if (base == Core::kBase) {
    return core;
  }
  for (const Place& place : places_) {
    if (place.peripheral->base() == base) {
      check_usable(place, address);
      return *place.peripheral;
    }
  }
  throw Fault(address, "no peripheral has this address");
}

/// Throws Fault if the peripheral has no clock, has had its clock for too few cycles, or is held in reset. On
/// a chip, an access to a peripheral without a clock causes a fault, and a peripheral that is held in reset
/// ignores every access. Each of these accesses is an error of a driver.
void Microcontroller::check_usable(const Place& place, std::uint32_t address) const {
  switch (system_control.gate(place.gate_index, place.gate_bit)) {
    case SystemControl::Gate::Shut:
      throw Fault(address, "the peripheral has no clock");
    case SystemControl::Gate::TooFresh:
      throw Fault(address,
                  "the clock gate of the peripheral was opened too recently; wait for the clock cycles that "
                  "the data sheet requires");
    case SystemControl::Gate::Open:
      break;
  }
  if (system_control.holds_in_reset(place.gate_index, place.gate_bit)) {
    throw Fault(address, "the peripheral is held in reset");
  }
}

void Microcontroller::check_reset() const {
  if (reset_requested_) {
    throw ResetRequest{*reset_requested_};
  }
}

void Microcontroller::pass(Instant to) {
  if (pass_) {
    pass_(to);
  } else {
    timeline_.advance(to);
  }
  check_reset();
}

void Microcontroller::pass_all(Instant to) {
  while (timeline_.now() < to) {
    pass(to);
  }
}

/// If the test has requested that the firmware hangs here, lets time pass until a C++ exception is thrown,
/// for example a ResetRequest.
void Microcontroller::hang_if_requested() {
  if (hangs_ == Hangs::MainLoop && !core.in_handler()) {
    run_until(kNever);
  }
  while (hangs_ == Hangs::Handler && core.in_handler()) {
    pass(std::max(timeline_.next(), timeline_.now() + Instant(1)));
  }
}

void Microcontroller::begin_access(std::uint32_t address, bool write, std::uint32_t value) {
  pass_all(timeline_.now() + clocks_an_access_ * system_control.cycle());
  hang_if_requested();
  core.serve_pending();
  ++accesses_;
  if (recording_) {
    recorded_.push_back({timeline_.now(), address, value, write});
  }
}

std::uint32_t Microcontroller::read(std::uint32_t address) {
  begin_access(address, false, 0);
  const std::uint32_t value = peripheral_at(address).read(address & 0xFFFU);
  if (recording_) {
    recorded_.back().value = value;
  }
  return value;
}

void Microcontroller::write(std::uint32_t address, std::uint32_t value) {
  begin_access(address, true, value);
  peripheral_at(address).write(address & 0xFFFU, value);
  check_reset();
}

void Microcontroller::disable_interrupts() {
  core.hold(true);
  held_since_ = accesses_;
}

void Microcontroller::enable_interrupts() {
  most_held_ = std::max(most_held_, accesses_ - held_since_);
  core.hold(false);
  core.serve_pending();
}

void Microcontroller::wait_for_interrupt() {
  while (!core.wakes()) {
    const Instant next = std::min(timeline_.next(), core.next_wake());
    if (next == kNever && !pass_) {
      throw Fault(0, "the processor sleeps, and no further event can wake it");
    }
    pass(next);
  }
}

void Microcontroller::run_until(Instant when) {
  core.serve_pending();
  while (timeline_.now() < when) {
    const Instant wakes = core.held() ? kNever : std::max(core.next_wake(), timeline_.now() + Instant(1));
    pass(std::min({when, timeline_.next(), wakes}));
    core.serve_pending();
  }
}

}  // namespace ex9000::registers

namespace ex9000::hal {

std::uint32_t bus::read(std::uint32_t address) { return registers::Microcontroller::current().read(address); }
void bus::write(std::uint32_t address, std::uint32_t value) {
  registers::Microcontroller::current().write(address, value);
}
void cortex_m::processor::disable_interrupts() { registers::Microcontroller::current().disable_interrupts(); }
void cortex_m::processor::enable_interrupts() { registers::Microcontroller::current().enable_interrupts(); }
void cortex_m::processor::wait_for_interrupt() { registers::Microcontroller::current().wait_for_interrupt(); }

}  // namespace ex9000::hal
