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

Refusal write_address(const State& /*state*/, unsigned /*index*/, std::uint16_t value, Outcome& outcome) {
  if (!is_modbus_address(value)) {
    return Refusal::WrongValue;  // even if the stored protocol is ASCII, which permits more addresses
  }
  outcome.change().address = static_cast<std::uint8_t>(value);
  return Refusal::None;
}

Refusal write_watchdog_timeout(const State& state, unsigned /*index*/, std::uint16_t value,
                               Outcome& outcome) {
  if (state.settings.watchdog_enabled) {
    outcome.request(Effect::RestartHostWatchdog);
  }
  return write_word_to(outcome.change().watchdog_timeout, value);
}

}  // namespace ex9000::modbus
