// Coils and registers of the reference: wire.md 7, map.
#include <algorithm>

#include "tests/oracles/reference/extension_registers.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

namespace {

/// The kinds of coils: the rows of the table in wire.md 7.
enum class Row {
  Outputs,
  Safe,
  PowerOn,
  Inputs,
  LatchHigh,
  LatchLow,
  Protocol,
  Enable,
  ClearLatches,
  TimeoutStatus,
  ClearCounters,
  CountingEdge,
  None
};

struct CoilRow {
  Row row;
  const char* name;
  unsigned first;
  unsigned count;
  bool by_01, by_05, by_0f;
};

/// Returns the row of the table that contains this coil. Returns a row with Row::None if the model has no
/// such coil.
CoilRow coil_row(const ModelRow& model, unsigned address) {
  const unsigned outputs = model.outputs;
  const unsigned inputs = model.inputs;
  const CoilRow rows[] = {
      {Row::Outputs, "coil 0x0000", 0x0000, outputs, true, true, true},
      {Row::Safe, "coil 0x0080", 0x0080, outputs, true, true, true},
      {Row::PowerOn, "coil 0x00A0", 0x00A0, outputs, true, true, true},
      {Row::Inputs, "coil 0x0020", 0x0020, inputs, true, false, false},
      {Row::LatchHigh, "coil 0x0040", 0x0040, inputs, true, false, false},
      {Row::LatchLow, "coil 0x0060", 0x0060, inputs, true, false, false},
      {Row::Protocol, "coil 0x0100", 0x0100, 1, true, true, false},
      {Row::Enable, "coil 0x0104", 0x0104, 1, true, true, false},
      {Row::ClearLatches, "coil 0x0107", 0x0107, inputs != 0 ? 1U : 0U, false, true, false},
      {Row::TimeoutStatus, "coil 0x010D", 0x010D, 1, true, true, false},
      {Row::ClearCounters, "coil 0x0200", 0x0200, inputs, false, true, true},
      {Row::CountingEdge, "coil 0x08CA", 0x08CA, inputs != 0 ? 1U : 0U, true, true, false},
  };
  for (const CoilRow& row : rows) {
    if (address >= row.first && address < row.first + row.count) {
      return row;
    }
  }
  return {Row::None, "", 0, 0, false, false, false};
}

bool coil_listed(const CoilRow& row, unsigned function) {
  return function == 0x01 ? row.by_01 : function == 0x05 ? row.by_05 : row.by_0f;
}

/// Returns the row that contains a range of coils. Throws Exception 02 if the range extends beyond one row,
/// or if the table does not list the coils for this model and this function.
CoilRow listed_coils(const ModelRow& model, unsigned first, unsigned quantity, unsigned function) {
  const CoilRow row = coil_row(model, first);
  if (!coil_listed(row, function) || first + quantity > row.first + row.count) {
    throw Exception{0x02, function_name(function) + " 02"};
  }
  return row;
}

/// The identity registers that are only read: extensions.md.
struct TextRow {
  unsigned first;
  unsigned count;
};
constexpr TextRow kLine{0x006E, 3};
constexpr TextRow kModelText{0x00C8, 20};
constexpr TextRow kVersionText{0x00FA, 16};
constexpr TextRow kSignatureText{0x0122, 12};
constexpr TextRow kBootLoaderText{0x014A, 8};
/// Of an update: extensions.md.
constexpr TextRow kUpdateState{0x1010, 3};
constexpr unsigned kUpdateAction = 0x1013;
constexpr unsigned kBeginFirst = 0x1000;
constexpr unsigned kBlockFirst = 0x2000;
constexpr unsigned kBeginCount = 16;
constexpr unsigned kBlockCount = 68;
constexpr unsigned kLinePreparation = 0x0083;

bool is_in(TextRow row, unsigned address) { return address >= row.first && address < row.first + row.count; }

/// One character in each register.
unsigned character(const std::string& text, unsigned index) {
  return index < text.size() ? static_cast<unsigned char>(text[index]) : 0;
}

/// Returns whether the table lists this register for this model and this function.
bool register_listed(const ModelRow& model, unsigned address, unsigned function) {
  const bool counter = address < model.inputs;
  const bool code = address == 0x01E2 || address == 0x01E3;
  const bool setting = address == 0x01E4 || address == 0x01E5 || address == 0x01E8;
  const bool own_address = address == 0x0080;
  const bool text = is_in(kLine, address) || is_in(kModelText, address) || is_in(kVersionText, address) ||
                    is_in(kSignatureText, address) || is_in(kBootLoaderText, address) ||
                    is_in(kUpdateState, address);
  const bool action = address == kUpdateAction || address == kLinePreparation;
  const ExtensionRow extension = extension_row(model, address);
  switch (function) {
    case 0x03:
      return counter || code || setting || own_address || text || extension.row != Extension::None;
    case 0x04:
      return counter || own_address || text || extension.row != Extension::None;
    default:
      return setting || own_address || action || extension.written;
  }
}

std::string register_name(const ModelRow& model, unsigned address) {
  const ExtensionRow extension = extension_row(model, address);
  return address < 16                       ? "counter"
         : extension.row != Extension::None ? extension.name
                                            : "0x" + hex(address, 4);
}

void all_registers_listed(const ModelRow& model, unsigned first, unsigned quantity, unsigned function) {
  for (unsigned i = 0; i < quantity; ++i) {
    if (!register_listed(model, first + i, function)) {
      throw Exception{0x02, function_name(function) + " 02"};
    }
  }
}

}  // namespace

bool Module::coil(unsigned address) const {
  const CoilRow row = coil_row(*row_, address);
  const unsigned channel = address - row.first;
  const auto bit = [channel](unsigned value) { return (value >> channel & 1U) != 0; };
  switch (row.row) {
    case Row::Outputs:
      return bit(outputs_);
    case Row::Safe:
      return bit(stored_.safe);
    case Row::PowerOn:
      return bit(stored_.power_on);
    case Row::Inputs:
      return bit(levels_);
    case Row::LatchHigh:
      return bit(latch_high_);
    case Row::LatchLow:
      return bit(latch_low_);
    case Row::Protocol:
      return stored_.modbus;
    case Row::Enable:
      return stored_.enabled;
    case Row::TimeoutStatus:
      return stored_.timed_out;
    case Row::CountingEdge:
      return (stored_.format & 0x80U) != 0;
    default:
      return false;  // not readable
  }
}

/// Executes functions 01 and 02.
Bytes Module::read_bits(const Bytes& frame) {
  const unsigned function = frame[1];
  length_must_be(frame, 6);
  const unsigned first = word(frame, 2);
  const unsigned quantity = word(frame, 4);
  quantity_must_be(quantity, 2000, function);
  if (function == 0x01) {
    listed_coils(*row_, first, quantity, function);
  } else if (first + quantity > row_->inputs) {
    throw Exception{0x02, "FC02 02"};
  }
  Bytes reply = {frame[0], frame[1], static_cast<std::uint8_t>((quantity + 7) / 8)};
  reply.resize(3 + (quantity + 7) / 8);
  for (unsigned i = 0; i < quantity; ++i) {
    const bool on = function == 0x01 ? coil(first + i) : (levels_ >> (first + i) & 1U) != 0;
    if (on) {
      reply[3 + i / 8] = static_cast<std::uint8_t>(reply[3 + i / 8] | 1U << i % 8);
    }
  }
  return reply;
}

unsigned Module::register_value(unsigned address) {
  switch (address) {
    case 0x01E2:
      return row_->code >> 8;
    case 0x01E3:
      return unsigned{row_->code} << 8U & 0xFF00U;
    case 0x01E4:
      return stored_.address;
    case 0x01E5:
      return stored_.baud_code;
    case 0x01E8:
      return stored_.timeout;
    case 0x0080:
      return address_;
    default:
      if (is_in(kLine, address)) {
        const unsigned format = baud_code_ / 0x40;  // 8N1, 8N2, 8E1, 8O1
        constexpr unsigned kParity[] = {0, 0, 2, 1};
        return address == 0x006E ? rate() / 100 : address == 0x006F ? kParity[format] : format == 1 ? 2 : 1;
      }
      if (is_in(kModelText, address)) {
        return character(model_text(), address - kModelText.first);
      }
      if (is_in(kVersionText, address)) {
        return character(version_text(), address - kVersionText.first);
      }
      if (is_in(kSignatureText, address)) {
        return character(signature(), address - kSignatureText.first);
      }
      if (is_in(kBootLoaderText, address)) {
        return character("1.0", address - kBootLoaderText.first);
      }
      if (is_in(kUpdateState, address)) {
        return address == kUpdateState.first       ? static_cast<unsigned>(update_.state)
               : address == kUpdateState.first + 1 ? next_offset() >> 16U
                                                   : next_offset() & 0xFFFFU;
      }
      return address < 16 ? counters_[address] : extension_word(address);
  }
}

/// Executes functions 03 and 04.
Bytes Module::read_registers(const Bytes& frame) {
  const unsigned function = frame[1];
  length_must_be(frame, 6);
  const unsigned first = word(frame, 2);
  const unsigned quantity = word(frame, 4);
  quantity_must_be(quantity, 125, function);
  all_registers_listed(*row_, first, quantity, function);
  Bytes reply = {frame[0], frame[1], static_cast<std::uint8_t>(2 * quantity)};
  for (unsigned i = 0; i < quantity; ++i) {
    append_word(reply, register_value(first + i));
  }
  return reply;
}

/// Checks the values, then the timeout status. The caller has checked format and range.
void Module::judge_coils(unsigned first, const std::vector<bool>& values, unsigned function) {
  const CoilRow row = coil_row(*row_, first);
  const std::string value_refused = function_name(function) + " 03 " + row.name;
  switch (row.row) {
    case Row::Enable:
      if (values[0] && stored_.timeout == 0) {
        throw Exception{0x03, value_refused};
      }
      break;
    case Row::ClearLatches:
    case Row::TimeoutStatus:
      if (!values[0]) {
        throw Exception{0x03, value_refused};
      }
      break;
    case Row::ClearCounters:
      // wire.md 7: in 0F, a 0 bit leaves the counter unchanged; 05 with 0000 is refused.
      if (function == 0x05 && !values[0]) {
        throw Exception{0x03, value_refused};
      }
      break;
    case Row::Outputs:
    case Row::Safe:
    case Row::PowerOn:
      // wire.md 6: commands that drive outputs are refused while the timeout status is set.
      if (refuses_outputs()) {
        throw Exception{0x04, function_name(function) + " 04 " + row.name};
      }
      break;
    default:
      break;
  }
}

void Module::set_coils(unsigned first, const std::vector<bool>& values) {
  const CoilRow row = coil_row(*row_, first);
  for (unsigned i = 0; i < values.size(); ++i) {
    const unsigned channel = first + i - row.first;
    const auto put = [&](unsigned& value) {
      value = values[i] ? value | 1U << channel : value & ~(1U << channel);
    };
    switch (row.row) {
      case Row::Outputs:
        drive(1U << channel, values[i] ? 1U << channel : 0U);
        break;
      case Row::Safe:
        // A write of the safe value or of the power-on value also drives the outputs.
        put(set().safe);
        drive(1U << channel, values[i] ? 1U << channel : 0U);
        break;
      case Row::PowerOn:
        put(set().power_on);
        drive(1U << channel, values[i] ? 1U << channel : 0U);
        break;
      case Row::Protocol:
        set().modbus = values[i];
        break;
      case Row::Enable:
        set().enabled = values[i];
        restart_host_watchdog();
        break;
      case Row::ClearLatches:
        clear_latches();
        break;
      case Row::TimeoutStatus:
        clear_timeout_status();
        break;
      case Row::CountingEdge:
        // This setting takes effect immediately. Bit 7 of FF in `%AANNTTCCFF` takes effect at the next reset.
        set().format = values[i] ? stored_.format | 0x80U : stored_.format & 0x7FU;
        counts_rising_ = values[i];
        break;
      case Row::ClearCounters:
        if (values[i]) {
          clear_counter(channel);
        }
        break;
      default:
        break;
    }
  }
}

Bytes Module::write_coil(const Bytes& frame) {
  length_must_be(frame, 6);
  const unsigned address = word(frame, 2);
  const unsigned value = word(frame, 4);
  if (value != 0xFF00 && value != 0x0000) {
    throw Exception{0x03, "FC05 03 neither FF00 nor 0000"};
  }
  const CoilRow row = listed_coils(*row_, address, 1, 0x05);
  const std::vector<bool> values = {value == 0xFF00};
  judge_coils(address, values, 0x05);
  // A broadcast never changes the protocol or the counting edge.
  if (frame[0] == 0 && (row.row == Row::Protocol || row.row == Row::CountingEdge)) {
    return {};
  }
  set_coils(address, values);
  return frame;
}

Bytes Module::write_coils(const Bytes& frame) {
  if (frame.size() < 7) {
    throw Exception{0x03, "FC0F 03 length"};
  }
  const unsigned first = word(frame, 2);
  const unsigned quantity = word(frame, 4);
  quantity_must_be(quantity, 1968, 0x0F);
  const unsigned bytes = (quantity + 7) / 8;
  if (frame[6] != bytes) {
    throw Exception{0x03, "FC0F 03 byte count"};
  }
  length_must_be(frame, 7 + bytes);
  listed_coils(*row_, first, quantity, 0x0F);
  std::vector<bool> values;
  for (unsigned i = 0; i < quantity; ++i) {
    values.push_back((frame[7 + i / 8] >> i % 8 & 1U) != 0);
  }
  judge_coils(first, values, 0x0F);
  set_coils(first, values);
  return Bytes(frame.begin(), frame.begin() + 6);
}

void Module::judge_registers(unsigned first, const std::vector<unsigned>& values) {
  const ExtensionRow row = extension_row(*row_, first);
  // The specification does not say whether the permission or the value is judged first.
  if (row.permission && !permission() && (values[0] <= row.highest || choice(2) == 0)) {
    throw Exception{0x04, std::string("register ") + row.name + " 04 without permission"};
  }
  for (unsigned i = 0; i < values.size(); ++i) {
    const unsigned value = values[i];
    switch (first + i) {
      case 0x0080:
      case 0x01E4:
        if (value < 1 || value > 247) {
          throw Exception{0x03, "register " + register_name(*row_, first + i) + " 03"};
        }
        break;
      case 0x01E5:
        if (!baud_code_exists(value)) {
          throw Exception{0x03, value < 0x40 || value > 0xFF ? "register 0x01E5 03"
                                                             : "register 0x01E5 03 with a line format"};
        }
        break;
      case 0x01E8:
        if (value > 255) {
          throw Exception{0x03, "register 0x01E8 03"};
        }
        if (value == 0 && stored_.enabled) {
          throw Exception{0x03, "register 0x01E8 03 value 0 while enabled"};
        }
        break;
      case kLinePreparation:
        if (value != 1) {
          throw Exception{0x03, "register 0x0083 03"};
        }
        break;
      case kUpdateAction:
        judge_update_action(value);
        break;
      default:
        if (value > extension_row(*row_, first + i).highest) {
          throw Exception{0x03, "register " + register_name(*row_, first + i) + " 03"};
        }
        break;
    }
  }
  if (extension_row(*row_, first).row == Extension::SerialNumber) {
    const bool both = first == 0x010E && values.size() == 2;
    if (!both || (values[0] != 0x0D00 && (values[0] | values[1]) != 0)) {
      throw Exception{0x03, "register 0x010E 03"};
    }
  }
  if (extension_row(*row_, first).row == Extension::TimedOutputs && refuses_outputs()) {
    throw Exception{0x04, "register 0x0280 04"};
  }
}

void Module::set_registers(unsigned first, const std::vector<unsigned>& values) {
  for (unsigned i = 0; i < values.size(); ++i) {
    switch (first + i) {
      case 0x01E4:
        set().address = values[i];  // takes effect at the next reset
        break;
      case 0x0080:
        address_ = set().address = values[i];
        break;
      case 0x01E5:
        set().baud_code = values[i];  // takes effect at the next reset
        break;
      case 0x01E8:
        set().timeout = values[i];
        restart_host_watchdog();
        break;
      case kLinePreparation:
        break;
      case kUpdateAction:
        act_on_update(values[i]);
        break;
      default:
        set_extension(first + i, values[i]);
        break;
    }
  }
}

/// Returns whether the module ignores a broadcast that writes registers from `first` on. The result is the
/// same for all registers that one request can write.
bool Module::broadcast_ignored(unsigned first) {
  if (first == 0x0080 || first == 0x01E4 || first == 0x01E5 || first == kUpdateAction ||
      first == kLinePreparation) {
    return true;
  }
  if (extension_row(*row_, first).row == Extension::TimedOutputs) {
    return false;
  }
  if (extension_row(*row_, first).row != Extension::None) {
    return true;
  }
  return false;
}

Bytes Module::write_register(const Bytes& frame) {
  length_must_be(frame, 6);
  const unsigned address = word(frame, 2);
  all_registers_listed(*row_, address, 1, 0x06);
  judge_registers(address, {word(frame, 4)});
  if (frame[0] == 0 && broadcast_ignored(address)) {
    return {};
  }
  set_registers(address, {word(frame, 4)});
  return frame;
}

Bytes Module::write_registers(const Bytes& frame) {
  if (frame.size() < 7) {
    throw Exception{0x03, "FC10 03 length"};
  }
  const unsigned first = word(frame, 2);
  const unsigned quantity = word(frame, 4);
  quantity_must_be(quantity, 123, 0x10);
  if (frame[6] != 2 * quantity) {
    throw Exception{0x03, "FC10 03 byte count"};
  }
  length_must_be(frame, 7 + 2 * quantity);
  const bool begins = first == kBeginFirst && quantity == kBeginCount;
  if (begins || (first == kBlockFirst && quantity == kBlockCount)) {
    if (frame[0] != 0) {
      const Bytes data(frame.begin() + 7, frame.end());
      begins ? begin_update(data) : receive_block(data);
    }
    return Bytes(frame.begin(), frame.begin() + 6);
  }
  all_registers_listed(*row_, first, quantity, 0x10);
  std::vector<unsigned> values;
  for (unsigned i = 0; i < quantity; ++i) {
    values.push_back(word(frame, 7 + 2 * i));
  }
  judge_registers(first, values);
  if (frame[0] == 0 && broadcast_ignored(first)) {
    return {};
  }
  set_registers(first, values);
  return Bytes(frame.begin(), frame.begin() + 6);
}

}  // namespace ex9000::reference
