// The Modbus register map, one table row for each range of coils, discrete inputs or registers - wire.md
// section 7 and extensions.md.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

#include "firmware/line/rtu_frames.hpp"
#include "firmware/model/model.hpp"
#include "firmware/request/exchange.hpp"
#include "firmware/request/outcome.hpp"
#include "firmware/request/state.hpp"

namespace ex9000::modbus {

/// A set of function codes that can access a row; bit n is function n.
using Functions = std::uint16_t;
constexpr Functions kReadCoils = 1U << 0x1U;
constexpr Functions kReadDiscreteInputs = 1U << 0x2U;
constexpr Functions kReadHoldingRegisters = 1U << 0x3U;
constexpr Functions kReadInputRegisters = 1U << 0x4U;
constexpr Functions kWriteSingleCoil = 1U << 0x5U;
constexpr Functions kWriteSingleRegister = 1U << 0x6U;
constexpr Functions kWriteMultipleCoils = 1U << 0xFU;
/// Functions 06 and 10 (hex) can always access the same rows, so they share one bit.
constexpr Functions kWriteRegisters = kWriteSingleRegister;

/// The number of coils, discrete inputs or registers of a row: a fixed number, the number of outputs or of
/// inputs of the model, or twice the number of its inputs.
enum class Width : std::uint8_t { One = 1, Two = 2, Eight = 8, PerOutput, PerInput, PairPerInput };

constexpr unsigned kLargestWidth = 32;

constexpr unsigned width_of(Width width, const Model& model) {
  if (width <= Width::Eight) {
    return static_cast<unsigned>(width);
  }
  if (width == Width::PerOutput) {
    return model.outputs;
  }
  return width == Width::PairPerInput ? 2U * model.inputs : model.inputs;
}

/// Additional rules for access to a row.
using Rules = std::uint8_t;
constexpr Rules kPlain = 0;
constexpr Rules kOnlyOn = 1U << 0U;         ///< exception 03 for function 05 with 0000
constexpr Rules kConfiguration = 1U << 1U;  ///< writes by broadcast are ignored
constexpr Rules kExtension = 1U << 2U;      ///< `~AAX` accesses the row too (firmware/extensions.md)
constexpr Rules kLong = 1U << 3U;           ///< pairs of registers with 32-bit values, high word first

/// A row of kBitRegisters without its texts. An image contains only this part of the row.
struct BitRow {
  std::uint16_t first = 0;
  Width width = Width::One;
  Needs needs = Needs::Nothing;
  Functions functions = 0;
  Rules rules = kPlain;
  /// Returns all bits of the row. Bit 0 is the value of the row's first coil or discrete input.
  std::uint16_t (*read)(const State& state) = nullptr;
  /// Writes the coils of the row whose bit is set in `bits.mask`.
  Refusal (*write)(const State& state, BitWrite bits, Outcome& outcome) = nullptr;

  [[nodiscard]] constexpr bool has(Rules rule) const { return (rules & rule) != 0; }
};

/// A row of kWordRegisters without its texts. An image contains only this part of the row.
struct WordRow {
  std::uint16_t first = 0;
  Width width = Width::One;
  Needs needs = Needs::Nothing;
  Functions functions = 0;
  Rules rules = kPlain;
  /// `index`: position of the register in the row, from 0.
  std::uint16_t (*read)(const Exchange& exchange, unsigned index) = nullptr;
  Refusal (*write)(const State& state, unsigned index, std::uint16_t value, Outcome& outcome) = nullptr;

  [[nodiscard]] constexpr bool has(Rules rule) const { return (rules & rule) != 0; }
};

// --- scalar settings: every value that the type of the setting can hold is left to Settings::possible_for
// ---

template <auto setting>
std::uint16_t read_bits_of(const State& state) {
  return static_cast<std::uint16_t>(state.settings.*setting);
}
template <auto setting>
std::uint16_t read_word_of(const Exchange& exchange, unsigned /*index*/) {
  return static_cast<std::uint16_t>(exchange.state.settings.*setting);
}
template <class Value>
Refusal write_word_to(std::optional<Value>& setting, std::uint16_t value) {
  if (value > std::numeric_limits<Value>::max()) {
    return Refusal::WrongValue;
  }
  setting = static_cast<Value>(value);
  return Refusal::None;
}
template <auto setting>
Refusal write_word_of(const State& /*state*/, unsigned /*index*/, std::uint16_t value, Outcome& outcome) {
  return write_word_to(outcome.change().*setting, value);
}

// bit_rows.cpp
std::uint16_t read_outputs(const State& state);
Refusal write_outputs(const State& state, BitWrite bits, Outcome& outcome);
Refusal write_safe_value(const State& state, BitWrite bits, Outcome& outcome);
Refusal write_power_on_value(const State& state, BitWrite bits, Outcome& outcome);
std::uint16_t read_inputs(const State& state);
std::uint16_t read_latch_high(const State& state);
std::uint16_t read_latch_low(const State& state);
Refusal write_protocol(const State& state, BitWrite bits, Outcome& outcome);
Refusal write_watchdog_enable(const State& state, BitWrite bits, Outcome& outcome);
Refusal write_clear_latches(const State& state, BitWrite bits, Outcome& outcome);
Refusal write_clear_timeout_status(const State& state, BitWrite bits, Outcome& outcome);
Refusal write_clear_counters(const State& state, BitWrite bits, Outcome& outcome);
std::uint16_t read_counting_edge(const State& state);
Refusal write_counting_edge(const State& state, BitWrite bits, Outcome& outcome);
// word_rows.cpp
std::uint16_t read_counter(const Exchange& exchange, unsigned index);
std::uint16_t read_module_code(const Exchange& exchange, unsigned index);
Refusal write_address(const State& state, unsigned index, std::uint16_t value, Outcome& outcome);
Refusal write_watchdog_timeout(const State& state, unsigned index, std::uint16_t value, Outcome& outcome);
// extension_rows.cpp
std::uint16_t read_input_filter(const Exchange& exchange, unsigned index);
Refusal write_input_filter(const State& state, unsigned index, std::uint16_t value, Outcome& outcome);
std::uint16_t read_long_counter(const Exchange& exchange, unsigned index);
std::uint16_t read_time_left(const Exchange& exchange, unsigned index);
Refusal write_timed_output(const State& state, unsigned index, std::uint16_t value, Outcome& outcome);
std::uint16_t read_version(const Exchange& exchange, unsigned index);
std::uint16_t read_reset_reason(const Exchange& exchange, unsigned index);
std::uint16_t read_seconds_up(const Exchange& exchange, unsigned index);
std::uint16_t read_timeout_count(const Exchange& exchange, unsigned index);
Refusal clear_timeout_count(const State& state, unsigned index, std::uint16_t value, Outcome& outcome);
std::uint16_t read_store_count(const Exchange& exchange, unsigned index);
std::uint16_t read_settings_source(const Exchange& exchange, unsigned index);
std::uint16_t read_tally(const Exchange& exchange, unsigned index);

/// A row with its documentation. The firmware never uses the texts, so an image does not contain them.
struct BitRegister {
  std::string_view id;  ///< identifies the row in exports and test coverage; must not change
  std::string_view meaning;
  std::string_view range;  ///< values that may be written; empty if the row is read-only
  BitRow row;
};

struct WordRegister {
  std::string_view id;
  std::string_view meaning;
  std::string_view range;
  WordRow row;
};

inline constexpr BitRegister kBitRegisters[] = {
    {"outputs",
     "outputs",
     "0 off, 1 on",
     {0x0000, Width::PerOutput, Needs::Outputs, kReadCoils | kWriteSingleCoil | kWriteMultipleCoils, kPlain,
      read_outputs, write_outputs}},
    {"inputs",
     "inputs",
     "",
     {0x0000, Width::PerInput, Needs::Inputs, kReadDiscreteInputs, kPlain, read_inputs, nullptr}},
    {"input-coils",
     "inputs",
     "",
     {0x0020, Width::PerInput, Needs::Inputs, kReadCoils, kPlain, read_inputs, nullptr}},
    {"latch-high",
     "latch high: a rising edge has occurred",
     "",
     {0x0040, Width::PerInput, Needs::Inputs, kReadCoils, kPlain, read_latch_high, nullptr}},
    {"latch-low",
     "latch low: a falling edge has occurred",
     "",
     {0x0060, Width::PerInput, Needs::Inputs, kReadCoils, kPlain, read_latch_low, nullptr}},
    {"safe-value",
     "safe value; a write also drives the outputs",
     "0 off, 1 on",
     {0x0080, Width::PerOutput, Needs::Outputs, kReadCoils | kWriteSingleCoil | kWriteMultipleCoils, kPlain,
      read_bits_of<&Settings::safe_value>, write_safe_value}},
    {"power-on-value",
     "power-on value; a write also drives the outputs",
     "0 off, 1 on",
     {0x00A0, Width::PerOutput, Needs::Outputs, kReadCoils | kWriteSingleCoil | kWriteMultipleCoils, kPlain,
      read_bits_of<&Settings::power_on_value>, write_power_on_value}},
    {"protocol",
     "stored protocol, in force from the next reset on",
     "0 ASCII, 1 Modbus RTU; not by broadcast",
     {0x0100, Width::One, Needs::Nothing, kReadCoils | kWriteSingleCoil, kConfiguration,
      read_bits_of<&Settings::protocol>, write_protocol}},
    {"watchdog-enable",
     "host watchdog enable",
     "0 off, 1 on and restart; 1 only if the timeout is not 0",
     {0x0104, Width::One, Needs::Nothing, kReadCoils | kWriteSingleCoil, kPlain,
      read_bits_of<&Settings::watchdog_enabled>, write_watchdog_enable}},
    {"clear-latches",
     "clear both latches of all channels",
     "1 only",
     {0x0107, Width::One, Needs::Inputs, kWriteSingleCoil, kOnlyOn, nullptr, write_clear_latches}},
    {"timeout-status",
     "host watchdog timeout status",
     "1 only: clears it",
     {0x010D, Width::One, Needs::Nothing, kReadCoils | kWriteSingleCoil, kOnlyOn,
      read_bits_of<&Settings::timeout_status>, write_clear_timeout_status}},
    {"clear-counters",
     "clear the channel's counter",
     "1 clears it; 0 changes nothing and requires function 0F",
     {0x0200, Width::PerInput, Needs::Inputs, kWriteSingleCoil | kWriteMultipleCoils, kOnlyOn, nullptr,
      write_clear_counters}},
    {"counting-edge",
     "edge that the counters count, stored and in force immediately",
     "0 falling, 1 rising; not by broadcast",
     {0x08CA, Width::One, Needs::Inputs, kReadCoils | kWriteSingleCoil, kConfiguration, read_counting_edge,
      write_counting_edge}},
};

constexpr Functions kReadRegisters = kReadHoldingRegisters | kReadInputRegisters;

inline constexpr WordRegister kWordRegisters[] = {
    {"counters",
     "input counters",
     "",
     {0x0000, Width::PerInput, Needs::Inputs, kReadHoldingRegisters | kReadInputRegisters, kPlain,
      read_counter, nullptr}},
    {"module-code",
     "module code in two registers; for example, the code 0x9042 is read as 0x0090 and 0x4200",
     "",
     {0x01E2, Width::Two, Needs::Nothing, kReadHoldingRegisters, kPlain, read_module_code, nullptr}},
    {"address",
     "stored address, in force from the next reset on",
     "1 to 247; not by broadcast",
     {0x01E4, Width::One, Needs::Nothing, kReadHoldingRegisters | kWriteRegisters, kConfiguration,
      read_word_of<&Settings::address>, write_address}},
    {"baud-code",
     "stored baud code with the line format, in force from the next reset on",
     "0x03 to 0x0A (8N1), 0x43 to 0x4A (8N2), 0x83 to 0x8A (8E1), 0xC3 to 0xCA (8O1); not by broadcast",
     {0x01E5, Width::One, Needs::Nothing, kReadHoldingRegisters | kWriteRegisters, kConfiguration,
      read_word_of<&Settings::baud_code>, write_word_of<&SettingsChange::baud_code>}},
    {"watchdog-timeout",
     "host watchdog timeout in units of 0.1 s",
     "0 to 255; not 0 while the host watchdog is enabled",
     {0x01E8, Width::One, Needs::Nothing, kReadHoldingRegisters | kWriteRegisters, kPlain,
      read_word_of<&Settings::watchdog_timeout>, write_watchdog_timeout}},
    // --- extension registers, 0x0240 to 0x030F ---
    {"input-filters",
     "filter of the input in ms: a level counts when it has been stable for this time",
     "0 to 2000; not by broadcast",
     {0x0240, Width::PerInput, Needs::Inputs, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_input_filter, write_input_filter}},
    {"inverted-inputs",
     "inverted inputs, bit n is input n",
     "only bits of inputs that the model has; not by broadcast",
     {0x0250, Width::One, Needs::Inputs, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_word_of<&Settings::inverted_inputs>, write_word_of<&SettingsChange::inverted_inputs>}},
    {"watchdog-feed",
     "requests that restart the host watchdog; 0: a host OK, and requests that enable the host "
     "watchdog or write its timeout; 1: also all other requests for this module",
     "0 or 1; not by broadcast",
     {0x0251, Width::One, Needs::Nothing, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_word_of<&Settings::fed_by_requests>, write_word_of<&SettingsChange::fed_by_requests>}},
    {"response-delay",
     "response delay in ms, in force from the next request on",
     "0 to 30; not by broadcast",
     {0x0252, Width::One, Needs::Nothing, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_word_of<&Settings::response_delay>, write_word_of<&SettingsChange::response_delay>}},
    {"long-counters",
     "input counters with 32 bits, two registers each, high word first",
     "",
     {0x0260, Width::PairPerInput, Needs::Inputs, kReadRegisters, kExtension | kLong, read_long_counter,
      nullptr}},
    {"timed-outputs",
     "timed output: the time until the output is switched off, in units of 0.1 s",
     "1 to 65535: switch on for this time; 0: switch off",
     {0x0280, Width::PerOutput, Needs::Outputs, kReadRegisters | kWriteRegisters, kExtension, read_time_left,
      write_timed_output}},
    {"version",
     "firmware version nn.nn, two BCD digits in each byte",
     "",
     {0x0300, Width::One, Needs::Nothing, kReadRegisters, kExtension, read_version, nullptr}},
    {"reset-reason",
     "reason of the last reset: 1 power-on, 2 module watchdog, 3 software, 4 reset pin, 5 fault; 0 if "
     "the board cannot detect it",
     "",
     {0x0301, Width::One, Needs::Nothing, kReadRegisters, kExtension, read_reset_reason, nullptr}},
    {"uptime",
     "seconds since reset, 32 bits, high word first",
     "",
     {0x0302, Width::Two, Needs::Nothing, kReadRegisters, kExtension | kLong, read_seconds_up, nullptr}},
    {"timeout-count",
     "timeouts of the host watchdog since reset or clearing, at most 65535",
     "0 only: clears it; not by broadcast",
     {0x0304, Width::One, Needs::Nothing, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_timeout_count, clear_timeout_count}},
    {"store-count",
     "stores of settings since reset, at most 65535",
     "",
     {0x0305, Width::One, Needs::Nothing, kReadRegisters, kExtension, read_store_count, nullptr}},
    {"settings-source",
     "source of the settings at reset: 0: a good copy, and no bad one; 1: a good copy, and a bad one; 2: "
     "factory settings, no good copy; 3: an older layout, not used so far; 4: factory settings, blank "
     "memory",
     "",
     {0x0306, Width::One, Needs::Nothing, kReadRegisters, kExtension, read_settings_source, nullptr}},
    {"line-tallies",
     "counts of the line: bus messages, bus errors, exceptions, messages for this module or for all "
     "modules, those without a reply, overruns, damaged bytes, frames lost because no buffer was free; "
     "they wrap",
     "",
     {0x0308, Width::Eight, Needs::Nothing, kReadRegisters, kExtension, read_tally, nullptr}},
    // This row is documentation only. The receiver detects a host OK, so no function uses this row.
    {"host-ok",
     "host OK: a request to read this register, with quantity 0 or 1, restarts the host watchdog "
     "and gets no reply; address 0 reaches all modules",
     "",
     {kHostOkRegister, Width::One, Needs::Nothing, 0, kPlain, nullptr, nullptr}},
};

/// Returns the row that `function` can access on this model, and that contains all `quantity` (1 to 2000)
/// coils or discrete inputs from `address` on. Returns null if there is no such row.
const BitRow* find_bits(const Model& model, Functions function, unsigned address, unsigned quantity);
/// Returns the row that `function` can access on this model, and that contains the register `address`.
/// Returns null if there is no such row. `address` may be above 0xFFFF; the result is then null.
const WordRow* find_word(const Model& model, Functions function, unsigned address);
/// Returns the row of the extension register `address` (0 to 0xFFFF), or null if this model has no extension
/// register with this address.
const WordRow* find_extension(const Model& model, unsigned address);

}  // namespace ex9000::modbus
