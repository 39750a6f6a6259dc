// The read and write functions of the registers, except the extension registers.
#include "firmware/modbus/registers.hpp"

namespace ex9000::modbus {

std::uint16_t read_counter(const Exchange& exchange, unsigned index) {
  return static_cast<std::uint16_t>(exchange.state.inputs.counter(index));
}

std::uint16_t read_module_code(const Exchange& exchange, unsigned index) {
  // Example: the code 0x9042 is read as 0x0090, 0x4200.
  const unsigned code = exchange.model().modbus_code;
  return static_cast<std::uint16_t>(index == 0 ? code >> 8U : code << 8U);
}

std::uint16_t read_address(const Exchange& exchange, unsigned /*index*/) {
  return exchange.state.settings.address;
}

Refusal write_address(const State& /*state*/, unsigned /*index*/, std::uint16_t value, Outcome& outcome) {
  outcome.change().address = static_cast<std::uint8_t>(value);
  return Refusal::None;
}

std::uint16_t read_baud_code(const Exchange& exchange, unsigned /*index*/) {
  return exchange.state.settings.baud_code;
}

Refusal write_baud_code(const State& /*state*/, unsigned /*index*/, std::uint16_t value, Outcome& outcome) {
  if (!is_baud_code(value)) {
    return Refusal::WrongValue;
  }
  outcome.change().baud_code = static_cast<std::uint8_t>(value);
  return Refusal::None;
}

std::uint16_t read_watchdog_timeout(const Exchange& exchange, unsigned /*index*/) {
  return exchange.state.settings.watchdog_timeout;
}

Refusal write_watchdog_timeout(const State& state, unsigned /*index*/, std::uint16_t value,
                               Outcome& outcome) {
  if (value == 0 && state.settings.watchdog_enabled) {
    return Refusal::WrongValue;
  }
  outcome.change().watchdog_timeout = static_cast<std::uint8_t>(value);
  if (state.settings.watchdog_enabled) {
    outcome.request(Effect::RestartHostWatchdog);
  }
  return Refusal::None;
}

}  // namespace ex9000::modbus
