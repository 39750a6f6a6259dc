// The read and write functions of the extension registers - firmware/extensions.md.
#include <optional>

#include "firmware/modbus/registers.hpp"
#include "firmware/modbus/tallies.hpp"

namespace ex9000::modbus {

namespace {

constexpr unsigned kBitsOfAWord = 16;

/// Returns a word of a 32-bit value; index 0 is the high word.
constexpr std::uint16_t word_of(std::uint32_t value, unsigned index) {
  return static_cast<std::uint16_t>(index == 0 ? value >> kBitsOfAWord : value);
}

/// Returns the version `Dnn.nn` as four BCD digits.
constexpr std::uint16_t version_in_bcd() {
  unsigned digits = 0;
  for (const char character : kFirmwareVersion) {
    if (character >= '0' && character <= '9') {
      digits = digits << 4U | static_cast<unsigned>(character - '0');
    }
  }
  return static_cast<std::uint16_t>(digits);
}

}  // namespace

std::uint16_t read_input_filter(const Exchange& exchange, unsigned index) {
  return exchange.state.settings.input_filters.of(index);
}

Refusal write_input_filter(const State& state, unsigned index, std::uint16_t value, Outcome& outcome) {
  // One request may write the filters of several channels.
  std::optional<InputFilters>& filters = outcome.change().input_filters;
  if (!filters) {
    filters = state.settings.input_filters;
  }
  filters->set(index, value);
  return Refusal::None;
}

std::uint16_t read_long_counter(const Exchange& exchange, unsigned index) {
  return word_of(exchange.state.inputs.long_counter(index / 2), index % 2);
}

std::uint16_t read_time_left(const Exchange& exchange, unsigned index) {
  return exchange.state.output_timers.left(index);
}

Refusal write_timed_output(const State& /*state*/, unsigned index, std::uint16_t value, Outcome& outcome) {
  outcome.drive_for(index, value);
  return Refusal::None;
}

std::uint16_t read_version(const Exchange& /*exchange*/, unsigned /*index*/) { return version_in_bcd(); }

std::uint16_t read_reset_reason(const Exchange& exchange, unsigned /*index*/) {
  return static_cast<std::uint16_t>(exchange.state.statistics.reset_reason);
}

std::uint16_t read_seconds_up(const Exchange& exchange, unsigned index) {
  return word_of(exchange.state.statistics.seconds_up, index);
}

std::uint16_t read_timeout_count(const Exchange& exchange, unsigned /*index*/) {
  return exchange.state.statistics.timeouts;
}

Refusal clear_timeout_count(const State& /*state*/, unsigned /*index*/, std::uint16_t value,
                            Outcome& outcome) {
  if (value != 0) {
    return Refusal::WrongValue;
  }
  outcome.request(Effect::ClearTimeoutCount);
  return Refusal::None;
}

std::uint16_t read_store_count(const Exchange& exchange, unsigned /*index*/) {
  return exchange.state.statistics.stores;
}

std::uint16_t read_settings_source(const Exchange& exchange, unsigned /*index*/) {
  return static_cast<std::uint16_t>(exchange.state.statistics.settings_source);
}

std::uint16_t read_tally(const Exchange& exchange, unsigned index) {
  return count_of(exchange, static_cast<Tally>(index));
}

}  // namespace ex9000::modbus
