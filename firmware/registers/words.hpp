// The registers, and the functions that read and write them - wire.md section 7, extensions.md.
#pragma once

#include <limits>
#include <optional>

#include "firmware/line/rtu_frames.hpp"
#include "firmware/registers/rows.hpp"
#include "firmware/registers/tallies.hpp"

namespace ex9000::registers {

template <auto setting>
std::uint16_t read_setting(const Exchange& exchange, unsigned /*index*/) {
  return static_cast<std::uint16_t>(exchange.state.settings.*setting);
}

/// Settings::possible_for judges every value that the setting's type can hold.
template <auto setting>
Refusal write_setting(const State& /*state*/, unsigned /*index*/, std::uint16_t value, Outcome& outcome) {
  using Value = typename std::decay_t<decltype(outcome.change().*setting)>::value_type;
  if (value > std::numeric_limits<Value>::max()) {
    return Refusal::WrongValue;
  }
  outcome.change().*setting = static_cast<Value>(value);
  return Refusal::None;
}

template <auto statistic>
std::uint16_t read_statistic(const Exchange& exchange, unsigned /*index*/) {
  return static_cast<std::uint16_t>(exchange.state.statistics.*statistic);
}

/// Index 0 is the high word.
constexpr std::uint16_t word_of(std::uint32_t value, unsigned index) {
  constexpr unsigned kBitsOfAWord = 16;
  return static_cast<std::uint16_t>(index == 0 ? value >> kBitsOfAWord : value);
}

inline std::uint16_t read_counter(const Exchange& exchange, unsigned index) {
  return static_cast<std::uint16_t>(exchange.state.inputs.counter(index));
}

inline std::uint16_t read_module_code(const Exchange& exchange, unsigned index) {
  const unsigned code = exchange.model().modbus_code;
  return static_cast<std::uint16_t>(index == 0 ? code >> 8U : code << 8U);
}

inline Refusal write_address(const State& state, unsigned index, std::uint16_t value, Outcome& outcome) {
  // Even if the stored protocol is ASCII, which permits more addresses.
  return is_modbus_address(value) ? write_setting<&SettingsChange::address>(state, index, value, outcome)
                                  : Refusal::WrongValue;
}

inline Refusal write_watchdog_timeout(const State& state, unsigned index, std::uint16_t value,
                                      Outcome& outcome) {
  if (state.settings.watchdog_enabled) {
    outcome.request(Effect::RestartHostWatchdog);
  }
  return write_setting<&SettingsChange::watchdog_timeout>(state, index, value, outcome);
}

inline std::uint16_t read_input_filter(const Exchange& exchange, unsigned index) {
  return exchange.state.settings.input_filters.of(index);
}

inline Refusal write_input_filter(const State& state, unsigned index, std::uint16_t value, Outcome& outcome) {
  // One request may write the filters of several channels.
  std::optional<InputFilters>& filters = outcome.change().input_filters;
  if (!filters) {
    filters = state.settings.input_filters;
  }
  filters->set(index, value);
  return Refusal::None;
}

inline std::uint16_t read_long_counter(const Exchange& exchange, unsigned index) {
  return word_of(exchange.state.inputs.long_counter(index / 2), index % 2);
}

inline std::uint16_t read_time_left(const Exchange& exchange, unsigned index) {
  return exchange.state.output_timers.left(index);
}

inline Refusal write_timed_output(const State& /*state*/, unsigned index, std::uint16_t value,
                                  Outcome& outcome) {
  outcome.drive_for(index, value);
  return Refusal::None;
}

inline std::uint16_t read_version(const Exchange& exchange, unsigned /*index*/) {
  return version_in_bcd(exchange.state.version.text());
}

inline std::uint16_t read_seconds_up(const Exchange& exchange, unsigned index) {
  return word_of(exchange.state.statistics.seconds_up, index);
}

inline Refusal clear_timeout_count(const State& /*state*/, unsigned /*index*/, std::uint16_t value,
                                   Outcome& outcome) {
  if (value != 0) {
    return Refusal::WrongValue;
  }
  outcome.request(Effect::ClearTimeoutCount);
  return Refusal::None;
}

inline std::uint16_t read_tally(const Exchange& exchange, unsigned index) {
  return count_of(exchange, static_cast<Tally>(index));
}

inline std::uint16_t read_own_address(const Exchange& exchange, unsigned /*index*/) {
  return exchange.state.in_force.address;
}

inline Refusal write_own_address(const State& state, unsigned index, std::uint16_t value, Outcome& outcome) {
  outcome.request(Effect::TakeAddress);
  return write_address(state, index, value, outcome);
}

inline std::uint16_t read_serial_number(const Exchange& exchange, unsigned index) {
  return word_of(exchange.state.serial_number(), index);
}

/// A request writes both words or none: a number with only one of them is not possible.
inline Refusal write_serial_number(const State& /*state*/, unsigned index, std::uint16_t value,
                                   Outcome& outcome) {
  constexpr unsigned kBitsOfAWord = 16;
  constexpr std::uint32_t kHalf = 0xFFFF'0000;
  std::optional<std::uint32_t>& number = outcome.change().serial_number;
  const std::uint32_t high = index == 0 || !number ? kHalf : *number << kBitsOfAWord;
  number = high | value;
  return Refusal::None;
}

/// The baud rate / 100; parity: none, odd, even; stop bits.
inline std::uint16_t read_line(const Exchange& exchange, unsigned index) {
  const std::uint8_t code = exchange.state.in_force.baud_code;
  const LineFormat format = line_format(code);
  if (index == 0) {
    return static_cast<std::uint16_t>(baud_rate(code) / 100);
  }
  if (index == 1) {
    return format == LineFormat::k8O1 ? 1 : format == LineFormat::k8E1 ? 2 : 0;
  }
  return format == LineFormat::k8N2 ? 2 : 1;
}

inline std::uint16_t read_model(const Exchange& exchange, unsigned index) {
  return exchange.model().short_designation(index);
}

inline std::uint16_t read_version_text(const Exchange& exchange, unsigned index) {
  const std::string_view text = exchange.state.version.text();
  return index < text.size() ? static_cast<std::uint8_t>(text[index]) : 0;
}

// --- the update, extensions.md, firmware update ---

inline std::uint16_t read_boot_loader(const Exchange& /*exchange*/, unsigned index) {
  constexpr std::string_view kText = kBuiltUpdate ? update::kBootLoaderVersion : "";
  return index < kText.size() ? static_cast<std::uint8_t>(kText[index]) : 0;
}

inline std::uint16_t read_signature(const Exchange& exchange, unsigned index) {
  return exchange.state.update.signature()[index];
}

inline Refusal write_updates_allowed(const State& state, unsigned index, std::uint16_t value,
                                     Outcome& outcome) {
  return state.configuration_permitted()
             ? write_setting<&SettingsChange::updates_allowed>(state, index, value, outcome)
             : Refusal::NotPermitted;
}

inline Refusal ask_update(const State& state, const update::Request& request, Outcome& outcome) {
  outcome.ask_update(request);
  return state.update.judge(request, state.settings.updates_allowed);
}

template <update::Ask ask>
Refusal write_to_update(const State& state, Bytes data, Outcome& outcome) {
  return ask_update(state, {ask, data}, outcome);
}

inline std::uint16_t read_update_state(const Exchange& exchange, unsigned /*index*/) {
  return static_cast<std::uint16_t>(exchange.state.update.state());
}

inline std::uint16_t read_update_offset(const Exchange& exchange, unsigned index) {
  return word_of(exchange.state.update.next(), index);
}

inline Refusal write_update_action(const State& state, unsigned /*index*/, std::uint16_t value,
                                   Outcome& outcome) {
  return value >= 1 && value <= static_cast<std::uint16_t>(update::Ask::Abandon)
             ? ask_update(state, {static_cast<update::Ask>(value), {}}, outcome)
             : Refusal::WrongValue;
}

/// A tool for other modules sets the line of their boot loader; this module's line stays as it is.
inline Refusal keep_line(const State& /*state*/, unsigned /*index*/, std::uint16_t value,
                         Outcome& /*outcome*/) {
  return value == 1 ? Refusal::None : Refusal::WrongValue;
}

inline constexpr WordRegister kWordRegisters[] = {
    {"counters",
     "input counters",
     "",
     {0x0000, Width::PerInput, Needs::Inputs, kReadRegisters, kPlain, read_counter, nullptr}},
    {"module-code",
     "module code in two registers; for example, the code 0x9042 is read as 0x0090 and 0x4200",
     "",
     {0x01E2, Width::Two, Needs::Nothing, kReadHoldingRegisters, kPlain, read_module_code, nullptr}},
    {"address",
     "stored address, in force from the next reset on",
     "1 to 247; not by broadcast",
     {0x01E4, Width::One, Needs::Nothing, kReadHoldingRegisters | kWriteRegisters, kConfiguration,
      read_setting<&Settings::address>, write_address}},
    {"baud-code",
     "stored baud code with the line format, in force from the next reset on",
     "0x03 to 0x0A (8N1), 0x43 to 0x4A (8N2), 0x83 to 0x8A (8E1), 0xC3 to 0xCA (8O1); not by broadcast",
     {0x01E5, Width::One, Needs::Nothing, kReadHoldingRegisters | kWriteRegisters, kConfiguration,
      read_setting<&Settings::baud_code>, write_setting<&SettingsChange::baud_code>}},
    {"watchdog-timeout",
     "host watchdog timeout in units of 0.1 s",
     "0 to 255; not 0 while the host watchdog is enabled",
     {0x01E8, Width::One, Needs::Nothing, kReadHoldingRegisters | kWriteRegisters, kPlain,
      read_setting<&Settings::watchdog_timeout>, write_watchdog_timeout}},
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
      read_setting<&Settings::inverted_inputs>, write_setting<&SettingsChange::inverted_inputs>}},
    {"watchdog-feed",
     "requests that restart the host watchdog; 0: a host OK, and requests that enable the host "
     "watchdog or write its timeout; 1: also all other requests for this module",
     "0 or 1; not by broadcast",
     {0x0251, Width::One, Needs::Nothing, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_setting<&Settings::fed_by_requests>, write_setting<&SettingsChange::fed_by_requests>}},
    {"response-delay",
     "response delay in ms, in force from the next request on",
     "0 to 30; not by broadcast",
     {0x0252, Width::One, Needs::Nothing, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_setting<&Settings::response_delay>, write_setting<&SettingsChange::response_delay>}},
    {"updates-allowed",
     "1: the firmware can be updated over the line; 0: it cannot",
     "0 or 1, with the configuration permission; not by broadcast",
     {0x0254, Width::One, Needs::ImageSlots, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_setting<&Settings::updates_allowed>, write_updates_allowed}},
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
     {0x0301, Width::One, Needs::Nothing, kReadRegisters, kExtension,
      read_statistic<&Statistics::reset_reason>, nullptr}},
    {"uptime",
     "seconds since reset, 32 bits, high word first",
     "",
     {0x0302, Width::Two, Needs::Nothing, kReadRegisters, kExtension | kLong, read_seconds_up, nullptr}},
    {"timeout-count",
     "timeouts of the host watchdog since reset or clearing, at most 65535",
     "0 only: clears it; not by broadcast",
     {0x0304, Width::One, Needs::Nothing, kReadRegisters | kWriteRegisters, kExtension | kConfiguration,
      read_statistic<&Statistics::timeouts>, clear_timeout_count}},
    {"store-count",
     "stores of settings since reset, at most 65535",
     "",
     {0x0305, Width::One, Needs::Nothing, kReadRegisters, kExtension, read_statistic<&Statistics::stores>,
      nullptr}},
    {"settings-source",
     "source of the settings at reset: 0: a good copy, and no bad one; 1: a good copy, and a bad one; 2: "
     "factory settings, no good copy; 3: an older layout, not used so far; 4: factory settings, blank "
     "memory",
     "",
     {0x0306, Width::One, Needs::Nothing, kReadRegisters, kExtension,
      read_statistic<&Statistics::settings_source>, nullptr}},
    {"line-tallies",
     "counts of the line: bus messages, bus errors, exceptions, messages for this module or for all "
     "modules, those without a reply, overruns, damaged bytes, frames lost because no buffer was free; "
     "they wrap",
     "",
     {0x0308, Width::Eight, Needs::Nothing, kReadRegisters, kExtension, read_tally, nullptr}},
    // --- identity, at the addresses of Wiren Board's modules ---
    {"own-address",
     "address in force; a new one is in force after the reply, and stored",
     "1 to 247; not by broadcast",
     {0x0080, Width::One, Needs::Nothing, kReadRegisters | kWriteRegisters, kConfiguration, read_own_address,
      write_own_address}},
    {"line",
     "the line in force: baud rate / 100; parity (0 none, 1 odd, 2 even); stop bits",
     "",
     {0x006E, Width::Three, Needs::Nothing, kReadRegisters, kPlain, read_line, nullptr}},
    {"model-text",
     "model without EX and -, for example 9042DM; one character in each register",
     "",
     {0x00C8, Width::Twenty, Needs::Nothing, kReadRegisters, kPlain, read_model, nullptr}},
    {"version-text",
     "firmware version; one character in each register",
     "",
     {0x00FA, Width::Sixteen, Needs::Nothing, kReadRegisters, kPlain, read_version_text, nullptr}},
    {"serial-number",
     "serial number, 32 bits, high word first; 0: none",
     "0x0D000000 to 0x0D00FFFF, or 0 for that of the board; both words together; not by broadcast",
     {0x010E, Width::Two, Needs::Nothing, kReadRegisters | kWriteRegisters,
      kExtension | kConfiguration | kLong, read_serial_number, write_serial_number}},
    {"boot-loader-text",
     "version of the boot loader, one character in each register; 0: there is none",
     "",
     {0x014A, Width::Eight, Needs::Nothing, kReadRegisters, kPlain, read_boot_loader, nullptr}},
    // --- the update of the firmware ---
    {"update-signature",
     "what an image must be for: model and board, for example 9042DM.pico; one character in each register",
     "",
     {0x0122, Width::Twelve, Needs::ImageSlots, kReadRegisters, kPlain, read_signature, nullptr}},
    {"update-begin",
     "what follows: signature, length of the image, version, flags, CRC-32",
     "all 16 registers at once, see extensions.md, firmware update",
     {0x1000, Width::Sixteen, Needs::ImageSlots, kWriteWholeRow, kConfiguration, nullptr, nullptr,
      write_to_update<update::Ask::Begin>}},
    {"update-block",
     "a block of the image: its offset, 128 bytes, CRC-32",
     "all 68 registers at once, see extensions.md, firmware update",
     {0x2000, Width::SixtyEight, Needs::ImageSlots, kWriteWholeRow, kConfiguration, nullptr, nullptr,
      write_to_update<update::Ask::Block>}},
    {"update-state",
     "state of the update: 0 none, 1 receiving, 2 complete and verified, 3 activation pending, 4 the new "
     "image is running and not confirmed, 5 taken back, 6 the flash failed",
     "",
     {0x1010, Width::One, Needs::ImageSlots, kReadRegisters, kPlain, read_update_state, nullptr}},
    {"update-offset",
     "offset of the next block in bytes, 32 bits, high word first",
     "",
     {0x1011, Width::Two, Needs::ImageSlots, kReadRegisters, kPlain, read_update_offset, nullptr}},
    {"update-action",
     "action of the update",
     "1: activate, with a reset after the reply; 2: confirm; 3: abandon; not by broadcast",
     {0x1013, Width::One, Needs::ImageSlots, kWriteRegisters, kConfiguration, nullptr, write_update_action}},
    {"boot-loader-line",
     "for tools that prepare the line of a boot loader; nothing changes",
     "1; not by broadcast",
     {0x0083, Width::One, Needs::ImageSlots, kWriteRegisters, kConfiguration, nullptr, keep_line}},
    // Documentation only: the receiver detects a host OK.
    {"host-ok",
     "host OK: a request to read this register, with quantity 0 or 1, restarts the host watchdog "
     "and gets no reply; address 0 reaches all modules",
     "",
     {modbus::kHostOkRegister, Width::One, Needs::Nothing, 0, kPlain, nullptr, nullptr}},
};

}  // namespace ex9000::registers
