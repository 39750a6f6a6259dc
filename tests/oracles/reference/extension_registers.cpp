// Values of the extension registers of the reference, and `~AARD` and `~AAX`: extensions.md.
#include "tests/oracles/reference/extension_registers.hpp"

#include "tests/oracles/reference/dcon_refusal.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

std::vector<ExtensionRow> extension_rows(const ModelRow& model) {
  const unsigned inputs = model.inputs;
  return {
      {Extension::SerialNumber, "0x010E", 0x010E, 2, true, true, 0xFFFF},
      {Extension::InputFilters, "0x0240", 0x0240, inputs, true, false, 2000},
      {Extension::Inversion, "0x0250", 0x0250, inputs != 0 ? 1U : 0U, true, false, (1U << inputs) - 1},
      {Extension::Setting, "0x0251", 0x0251, 1, true, false, 1, &Stored::restarted_by_requests},
      {Extension::Setting, "0x0252", 0x0252, 1, true, false, kLongestDelay, &Stored::delay},
      {Extension::Setting, "0x0254", 0x0254, model.both_protocols ? 1U : 0U, true, false, 1,
       &Stored::updates_allowed, true},
      {Extension::WideCounters, "0x0260", 0x0260, 2 * inputs, false, true},
      {Extension::TimedOutputs, "0x0280", 0x0280, model.outputs, true, false, 0xFFFF},
      {Extension::Version, "0x0300", 0x0300, 1},
      {Extension::ResetReason, "0x0301", 0x0301, 1},
      {Extension::Uptime, "0x0302", 0x0302, 2, false, true},
      {Extension::Timeouts, "0x0304", 0x0304, 1, true, false, 0},
      {Extension::Stores, "0x0305", 0x0305, 1},
      {Extension::SettingsSource, "0x0306", 0x0306, 1},
      {Extension::Tallies, "0x0308", 0x0308, 8},
  };
}

ExtensionRow extension_row(const ModelRow& model, unsigned address) {
  for (const ExtensionRow& row : extension_rows(model)) {
    if (address >= row.first && address < row.first + row.count) {
      return row;
    }
  }
  return {};
}

/// Returns a line tally; index 0 is register 0x0308. The tallies of overruns and lost frames are 0, because
/// no session has an overrun or loses a frame.
unsigned Module::tally(unsigned index) const {
  const unsigned tallies[] = {counts_.bus_messages,    counts_.crc_errors,  counts_.exceptions,
                              counts_.server_messages, counts_.no_response, counts_.lost,
                              counts_.bad_bytes,       counts_.lost};
  return tallies[index];
}

/// Returns the value of a register. If the register is a part of a 32-bit value, returns the 32-bit value.
unsigned Module::extension_value(unsigned address) {
  const ExtensionRow row = extension_row(*row_, address);
  switch (row.row) {
    case Extension::InputFilters:
      return stored_.filters[address - row.first];
    case Extension::Inversion:
      return stored_.inversion;
    case Extension::Setting:
      return stored_.*row.setting;
    case Extension::SerialNumber:
      return serial_number();
    case Extension::WideCounters:
      return wide_counters_[(address - row.first) / 2];
    case Extension::TimedOutputs:
      return time_left(address - row.first);
    case Extension::Version:
      return update_.running.version();
    case Extension::ResetReason:
      return reset_reason_;
    case Extension::Uptime:
      return seconds_since_reset();
    case Extension::Timeouts:
      return timeouts_;
    case Extension::Stores:
      return stores_;
    case Extension::SettingsSource:
      if (doubts_memory_) {
        return choice(5);
      }
      return read_blank_memory_ ? 4 : 0;
    case Extension::Tallies:
      return tally(address - row.first);
    default:
      return 0;  // not in the table
  }
}

unsigned Module::extension_word(unsigned address) {
  const ExtensionRow row = extension_row(*row_, address);
  const unsigned value = extension_value(address);
  return row.wide && (address - row.first) % 2 == 0 ? value >> 16 : value & 0xFFFFU;
}

void Module::set_extension(unsigned address, unsigned value) {
  const ExtensionRow row = extension_row(*row_, address);
  switch (row.row) {
    case Extension::InputFilters:
      set_filter(address - row.first, value);
      break;
    case Extension::Inversion:
      set_inversion(value);
      break;
    case Extension::Setting:
      set().*row.setting = value;
      break;
    case Extension::SerialNumber:
      stored_.serial_number = address == row.first ? value << 16 | (set().serial_number & 0xFFFFU)
                                                   : (set().serial_number & 0xFFFF0000U) | value;
      break;
    case Extension::TimedOutputs:
      set_timed_output(address - row.first, value);
      break;
    case Extension::Timeouts:
      timeouts_ = 0;
      break;
    default:
      break;
  }
}

/// Executes `~AARD` and `~AARDVV`.
std::string Module::delay_command(const std::string& body) {
  if (body == "D") {
    return "!" + aa() + hex(stored_.delay, 2);
  }
  const std::optional<unsigned> delay = number(body.size() == 3 ? body.substr(1) : "");
  if (!delay || body[0] != 'D') {
    throw Refused{"~AARD with a wrong form"};
  }
  if (*delay > kLongestDelay) {
    throw Refused{"~AARDVV out of range"};
  }
  set().delay = *delay;
  return "!" + aa();
}

/// Executes `~AAXRRRR` and `~AAXRRRRVVVV`.
std::string Module::extension_command(const std::string& body) {
  const std::optional<unsigned> digits = number(body);
  if ((body.size() != 4 && body.size() != 8) || !digits) {
    throw Refused{"~AAX with a wrong form"};
  }
  const bool writes = body.size() == 8;
  const unsigned address = writes ? *digits >> 16 : *digits;
  const ExtensionRow row = extension_row(*row_, address);
  if (row.row == Extension::None) {
    throw Refused{"~AAX register that the model does not have"};
  }
  if (!writes) {
    if (row.wide && (address - row.first) % 2 != 0) {
      throw Refused{"~AAXRRRR low word"};
    }
    return "!" + aa() + hex(extension_value(address), row.wide ? 8 : 4);
  }
  if (!row.written) {
    throw Refused{"~AAXRRRRVVVV to a read-only register"};
  }
  if (row.row == Extension::SerialNumber) {
    throw Refused{"~AAX writes one word of the serial number"};
  }
  const unsigned value = *digits & 0xFFFFU;
  if (value > row.highest) {
    throw Refused{std::string("~AAXRRRRVVVV ") + row.name + " out of range"};
  }
  if (row.permission && !permission()) {
    throw Refused{std::string("~AAXRRRRVVVV ") + row.name + " without permission"};
  }
  if (row.row == Extension::TimedOutputs && refuses_outputs()) {
    return "!";
  }
  set_extension(address, value);
  return "!" + aa();
}

}  // namespace ex9000::reference
