// Modbus RTU of the reference: wire.md 7.
#include <algorithm>

#include "tests/reference/hexadecimal.hpp"
#include "tests/reference/modbus_check.hpp"
#include "tests/reference/module.hpp"

namespace ex9000::reference {

namespace {

/// An exception: nothing is changed, and the answer is the function with bit 7 and the code.
struct Exception {
  std::uint8_t code;
  std::string rule;
};

constexpr unsigned kHostOk = 0x3038;

unsigned word(const Bytes& frame, std::size_t at) { return frame[at] * 256U + frame[at + 1]; }

void append_word(Bytes& frame, unsigned value) {
  frame.push_back(static_cast<std::uint8_t>(value >> 8 & 0xFFU));
  frame.push_back(static_cast<std::uint8_t>(value & 0xFFU));
}

void append_text(Bytes& frame, const std::string& text) {
  frame.insert(frame.end(), text.begin(), text.end());
}

/// As the rules have it.
std::string function_name(unsigned function) { return "FC" + hex(function, 2); }

/// What lies behind a coil's or register's address: a row of the table.
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
  None
};

struct CoilRow {
  Row row;
  const char* name;
  unsigned first;
  unsigned count;
  bool by_01, by_05, by_0f;
};

/// The table of coils for this model; rows of a length of 0 it lacks.
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

/// A coil range runs within one row; holes, what the model lacks and what is not listed for the function: 02.
CoilRow listed_coils(const ModelRow& model, unsigned first, unsigned quantity, unsigned function) {
  const CoilRow row = coil_row(model, first);
  if (!coil_listed(row, function) || first + quantity > row.first + row.count) {
    throw Exception{0x02, function_name(function) + " 02"};
  }
  return row;
}

/// The table of registers.
bool register_listed(const ModelRow& model, unsigned address, unsigned function) {
  const bool counter = address < model.inputs;
  const bool code = address == 0x01E2 || address == 0x01E3;
  const bool setting = address == 0x01E4 || address == 0x01E5 || address == 0x01E8;
  switch (function) {
    case 0x03:
      return counter || code || setting;
    case 0x04:
      return counter;
    default:
      return setting;
  }
}

void all_registers_listed(const ModelRow& model, unsigned first, unsigned quantity, unsigned function) {
  for (unsigned i = 0; i < quantity; ++i) {
    if (!register_listed(model, first + i, function)) {
      throw Exception{0x02, function_name(function) + " 02"};
    }
  }
}

bool known_function(const ModelRow& model, unsigned function) {
  const Bytes known = {0x01, 0x03, 0x04, 0x05, 0x06, 0x08, 0x0F, 0x10, 0x11, 0x2B, 0x46};
  return std::find(known.begin(), known.end(), function) != known.end() ||
         (function == 0x02 && model.inputs != 0);
}

/// The length of all of a frame but its CRC.
void length_must_be(const Bytes& frame, std::size_t length) {
  if (frame.size() != length) {
    throw Exception{0x03, function_name(frame[1]) + " 03 length"};
  }
}

void quantity_must_be(unsigned quantity, unsigned highest, unsigned function) {
  if (quantity == 0 || quantity > highest) {
    throw Exception{0x03, function_name(function) + " 03 quantity"};
  }
}

}  // namespace

/// A whole frame, whatever it is; the reply with its CRC, or nothing. What function 08 counts is as in Modbus
/// Application Protocol V1.1b3, 6.8, and, where that leaves it open, Modbus over Serial Line V1.02: a frame
/// too short to have a CRC is a CRC error, and a broadcast is a message without response.
Bytes Module::modbus_frame(Bytes frame) {
  // A turn-around 00 before a frame does not spoil it.
  if (frame.size() > 4 && !crc_is_right(frame) && frame[0] == 0x00) {
    if (frame.size() > 256) {
      left_open_ = "whether a frame of 256 bytes may have a turn-around 00 before it";
    }
    frame.erase(frame.begin());
    if (crc_is_right(frame)) {
      rule("turn-around 00 before a Modbus frame");
    }
  }
  // 4 to 256 bytes.
  if (frame.size() < 4) {
    rule("Modbus frame too short");
    counts_.crc_errors += 1;
    return {};
  }
  if (frame.size() > 256) {
    rule("Modbus frame too long");
    counts_.crc_errors += 1;
    return {};
  }
  if (!crc_is_right(frame)) {
    rule("CRC wrong");
    counts_.crc_errors += 1;
    return {};
  }
  frame.resize(frame.size() - 2);
  counts_.bus_messages += 1;
  const unsigned address = frame[0];
  const unsigned function = frame[1];
  if (address != 0 && address != address_) {
    rule("Modbus frame for another address");
    return {};
  }
  counts_.server_messages += 1;
  // Host OK is decided first, and never answered.
  if ((function == 0x03 || function == 0x04) && frame.size() == 6 && word(frame, 2) == kHostOk &&
      word(frame, 4) <= 1) {
    rule(std::string(address == 0 ? "broadcast " : "") + "host OK by " + function_name(function));
    counts_.no_response += 1;
    restart_host_watchdog();
    return {};
  }
  if (address == 0) {
    counts_.no_response += 1;
    const bool executed = function == 0x05 || function == 0x0F || function == 0x06 || function == 0x10;
    if (!executed) {
      rule("broadcast ignored: not a write");
      return {};
    }
  }
  Bytes reply;
  try {
    reply = modbus_function(frame);
    if (address == 0 && !reply.empty()) {
      rule("broadcast " + function_name(function));
    }
  } catch (const Exception& exception) {
    if (address == 0) {
      rule("broadcast refused");
    } else {
      rule(exception.rule);
      // V1.1b3, 6.8: the exception responses that were returned, so not those that a broadcast would have
      // got.
      counts_.exceptions += 1;
    }
    reply = {frame[0], static_cast<std::uint8_t>(function | 0x80U), exception.code};
  }
  return address == 0 ? Bytes{} : with_crc(reply);
}

Bytes Module::modbus_function(const Bytes& frame) {
  const unsigned function = frame[1];
  if (!known_function(row_, function)) {
    throw Exception{0x01, function == 0x02 ? "FC02 lacking" : "unknown function"};
  }
  switch (function) {
    case 0x01:
    case 0x02:
      return read_bits(frame);
    case 0x03:
    case 0x04:
      return read_registers(frame);
    case 0x05:
      return write_coil(frame);
    case 0x06:
      return write_register(frame);
    case 0x08:
      return diagnostics(frame);
    case 0x0F:
      return write_coils(frame);
    case 0x10:
      return write_registers(frame);
    case 0x11:
      return server_id(frame);
    case 0x2B:
      return device_identification(frame);
    default:
      return function_46(frame);
  }
}

bool Module::coil(unsigned address) const {
  const CoilRow row = coil_row(row_, address);
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
    default:
      return false;  // not to be read
  }
}

/// 01 and 02.
Bytes Module::read_bits(const Bytes& frame) {
  const unsigned function = frame[1];
  length_must_be(frame, 6);
  const unsigned first = word(frame, 2);
  const unsigned quantity = word(frame, 4);
  quantity_must_be(quantity, 2000, function);
  if (function == 0x01) {
    rule(std::string("FC01 ") + listed_coils(row_, first, quantity, function).name);
  } else if (first + quantity > row_.inputs) {
    throw Exception{0x02, "FC02 02"};
  } else {
    rule("FC02");
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

unsigned Module::register_value(unsigned address) const {
  switch (address) {
    case 0x01E2:
      return row_.code >> 8;
    case 0x01E3:
      return row_.code << 8 & 0xFF00U;
    case 0x01E4:
      return stored_.address;
    case 0x01E5:
      return stored_.baud_code;
    case 0x01E8:
      return stored_.timeout;
    default:
      return counters_[address];
  }
}

/// 03 and 04.
Bytes Module::read_registers(const Bytes& frame) {
  const unsigned function = frame[1];
  length_must_be(frame, 6);
  const unsigned first = word(frame, 2);
  const unsigned quantity = word(frame, 4);
  quantity_must_be(quantity, 125, function);
  all_registers_listed(row_, first, quantity, function);
  Bytes reply = {frame[0], frame[1], static_cast<std::uint8_t>(2 * quantity)};
  for (unsigned i = 0; i < quantity; ++i) {
    rule(function_name(function) + (first + i < 8 ? " counter" : " 0x" + hex(first + i, 4)));
    append_word(reply, register_value(first + i));
  }
  return reply;
}

/// Values, then the timeout status. Form and range have been judged.
void Module::judge_coils(unsigned first, const std::vector<bool>& values, unsigned function) {
  const CoilRow row = coil_row(row_, first);
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
      // E8: a 0 bit in 0F leaves the counter, 05 with 0000 is refused.
      if (function == 0x05 && !values[0]) {
        throw Exception{0x03, value_refused};
      }
      break;
    case Row::Outputs:
    case Row::Safe:
    case Row::PowerOn:
      // wire.md 6: what drives outputs is refused while the status is set.
      if (stored_.timed_out) {
        throw Exception{0x04, function_name(function) + " 04 " + row.name};
      }
      break;
    default:
      break;
  }
}

void Module::set_coils(unsigned first, const std::vector<bool>& values) {
  const CoilRow row = coil_row(row_, first);
  for (unsigned i = 0; i < values.size(); ++i) {
    const unsigned channel = first + i - row.first;
    const auto put = [&](unsigned& value) {
      value = values[i] ? value | 1U << channel : value & ~(1U << channel);
    };
    switch (row.row) {
      case Row::Outputs:
        put(outputs_);
        break;
      case Row::Safe:
        // The outputs follow.
        put(stored_.safe);
        put(outputs_);
        break;
      case Row::PowerOn:
        put(stored_.power_on);
        put(outputs_);
        break;
      case Row::Protocol:
        stored_.modbus = values[i];
        break;
      case Row::Enable:
        stored_.enabled = values[i];
        restart_host_watchdog();
        break;
      case Row::ClearLatches:
        clear_latches();
        break;
      case Row::TimeoutStatus:
        clear_timeout_status();
        break;
      case Row::ClearCounters:
        if (values[i]) {
          counters_[channel] = 0;
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
  const CoilRow row = listed_coils(row_, address, 1, 0x05);
  const std::vector<bool> values = {value == 0xFF00};
  judge_coils(address, values, 0x05);
  // Configuration is never broadcast.
  if (frame[0] == 0 && row.row == Row::Protocol) {
    rule("broadcast ignored: configuration");
    return {};
  }
  rule(std::string("FC05 ") + row.name);
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
  const CoilRow row = listed_coils(row_, first, quantity, 0x0F);
  std::vector<bool> values;
  for (unsigned i = 0; i < quantity; ++i) {
    values.push_back((frame[7 + i / 8] >> i % 8 & 1U) != 0);
  }
  judge_coils(first, values, 0x0F);
  rule(std::string("FC0F ") + row.name);
  set_coils(first, values);
  return Bytes(frame.begin(), frame.begin() + 6);
}

void Module::judge_registers(unsigned first, const std::vector<unsigned>& values) {
  for (unsigned i = 0; i < values.size(); ++i) {
    const unsigned value = values[i];
    switch (first + i) {
      case 0x01E4:
        if (value < 1 || value > 247) {
          throw Exception{0x03, "register 0x01E4 03"};
        }
        break;
      case 0x01E5:
        if (value < 0x03 || value > 0x0A) {
          throw Exception{0x03, "register 0x01E5 03"};
        }
        break;
      default:
        if (value > 255) {
          throw Exception{0x03, "register 0x01E8 03"};
        }
        if (value == 0 && stored_.enabled) {
          throw Exception{0x03, "register 0x01E8 03 0 while enabled"};
        }
        break;
    }
  }
}

void Module::set_registers(unsigned first, const std::vector<unsigned>& values) {
  for (unsigned i = 0; i < values.size(); ++i) {
    switch (first + i) {
      case 0x01E4:
        stored_.address = values[i];  // after reset
        break;
      case 0x01E5:
        stored_.baud_code = values[i];  // likewise
        break;
      default:
        stored_.timeout = values[i];
        restart_host_watchdog();
        break;
    }
  }
}

Bytes Module::write_register(const Bytes& frame) {
  length_must_be(frame, 6);
  const unsigned address = word(frame, 2);
  all_registers_listed(row_, address, 1, 0x06);
  judge_registers(address, {word(frame, 4)});
  if (frame[0] == 0 && address != 0x01E8) {
    rule("broadcast ignored: configuration");
    return {};
  }
  rule("FC06 0x" + hex(address, 4) + (address == 0x01E8 && stored_.enabled ? " restarts" : ""));
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
  all_registers_listed(row_, first, quantity, 0x10);
  std::vector<unsigned> values;
  for (unsigned i = 0; i < quantity; ++i) {
    values.push_back(word(frame, 7 + 2 * i));
  }
  judge_registers(first, values);
  if (frame[0] == 0 && first != 0x01E8) {
    rule("broadcast ignored: configuration");
    return {};
  }
  rule("FC10 0x" + hex(first, 4) + (quantity == 2 ? " and 0x01E5" : "") +
       (first == 0x01E8 && stored_.enabled ? " restarts" : ""));
  set_registers(first, values);
  return Bytes(frame.begin(), frame.begin() + 6);
}

/// 08; Modbus Application Protocol V1.1b3, 6.8.
Bytes Module::diagnostics(const Bytes& frame) {
  if (frame.size() < 4) {
    throw Exception{0x03, "FC08 03 length"};
  }
  const unsigned sub_function = word(frame, 2);
  const std::string name = "FC08 " + hex(sub_function, 2);
  if (sub_function == 0x00) {
    // N x 2 bytes, sent back as they came.
    if (frame.size() < 6 || frame.size() % 2 != 0) {
      throw Exception{0x03, "FC08 03 length"};
    }
    rule(name);
    return frame;
  }
  unsigned count = 0;
  switch (sub_function) {
    case 0x0A:
      break;
    case 0x0B:
      count = counts_.bus_messages;
      break;
    case 0x0C:
      count = counts_.crc_errors;
      break;
    case 0x0D:
      count = counts_.exceptions;
      break;
    case 0x0E:
      count = counts_.server_messages;
      break;
    case 0x0F:
      count = counts_.no_response;
      break;
    case 0x12:
      count = 0;  // a complete frame is always taken from the receiver in time here
      break;
    default:
      throw Exception{0x01, "FC08 01"};
  }
  length_must_be(frame, 6);
  if (word(frame, 4) != 0x0000) {
    throw Exception{0x03, "FC08 03 data"};
  }
  rule(name);
  if (sub_function == 0x0A) {
    counts_ = {};
    return frame;
  }
  Bytes reply(frame.begin(), frame.begin() + 4);
  append_word(reply, count);
  return reply;
}

Bytes Module::server_id(const Bytes& frame) {
  length_must_be(frame, 2);
  rule("FC11");
  Bytes reply = {frame[0], 0x11, static_cast<std::uint8_t>(3 + stored_.name.size())};
  append_word(reply, row_.code);
  reply.push_back(0xFF);
  append_text(reply, stored_.name);
  return reply;
}

/// 2B; Modbus Application Protocol V1.1b3, 6.21.
Bytes Module::device_identification(const Bytes& frame) {
  if (frame.size() < 3) {
    throw Exception{0x03, "FC2B 03 length"};
  }
  if (frame[2] != 0x0E) {
    throw Exception{0x01, "FC2B 01"};
  }
  length_must_be(frame, 5);
  const unsigned asked = frame[3];
  unsigned object = frame[4];
  if (asked < 0x01 || asked > 0x04) {
    throw Exception{0x03, "FC2B 03 code"};
  }
  const std::string texts[] = {"OpenEX9000",  row_.designation, "D01.00",    "",
                               row_.in_words, row_.designation, stored_.name};
  const auto present = [](unsigned id) { return id <= 0x06 && id != 0x03; };
  unsigned last = asked == 0x01 ? 0x02 : 0x06;
  if (asked == 0x04) {
    if (!present(object)) {
      throw Exception{0x02, "FC2B 02"};
    }
    last = object;
  } else if (!present(object) || object > last) {
    // 6.21: "If the Object Id does not match any known object, the server responds as if object 0 were
    // pointed out".
    object = 0x00;
  }
  rule("FC2B code " + hex(asked, 2));
  Bytes reply = {frame[0], 0x2B, 0x0E, static_cast<std::uint8_t>(asked), 0x82, 0x00, 0x00, 0x00};
  for (; object <= last; ++object) {
    if (present(object)) {
      reply[7] += 1;
      reply.push_back(static_cast<std::uint8_t>(object));
      reply.push_back(static_cast<std::uint8_t>(texts[object].size()));
      append_text(reply, texts[object]);
    }
  }
  return reply;
}

Bytes Module::function_46(const Bytes& frame) {
  if (frame.size() < 3) {
    throw Exception{0x03, "FC46 03 length"};
  }
  if (frame[2] == 0x00) {
    length_must_be(frame, 3);
    rule("FC46 00");
    Bytes reply = {frame[0], 0x46, 0x00, 0x00};
    append_word(reply, row_.code);
    reply.push_back(0x00);
    return reply;
  }
  if (frame[2] != 0x04) {
    throw Exception{0x02, "FC46 02"};
  }
  length_must_be(frame, 7);
  if (frame[3] < 1 || frame[3] > 247) {
    throw Exception{0x03, "FC46 03 range"};
  }
  if (frame[4] != 0 || frame[5] != 0 || frame[6] != 0) {
    throw Exception{0x03, "FC46 03 reserved"};
  }
  rule("FC46 04");
  stored_.address = frame[3];
  return {frame[0], 0x46, 0x04, 0x00, 0x00, 0x00, 0x00};
}

}  // namespace ex9000::reference
