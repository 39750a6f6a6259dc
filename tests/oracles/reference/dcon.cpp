// ASCII frames and commands of the reference: wire.md 3 and 4.
#include <algorithm>

#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/dcon_refusal.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

/// Returns the address that replies carry, except the replies to a valid `%` and to `$AA2`. In INIT mode this
/// address is 00 (wire.md 2).
std::string Module::aa() const { return hex(address_, 2); }

/// Returns the fields First and Second of a reply (wire.md 1).
std::string Module::first_second(unsigned outputs, unsigned inputs) const {
  if (row_->outputs > 8) {
    return hex(outputs >> 8, 2) + hex(outputs, 2);
  }
  if (row_->inputs > 8) {
    return hex(inputs >> 8, 2) + hex(inputs, 2);
  }
  return row_->outputs != 0 ? hex(outputs, 2) + hex(inputs, 2) : hex(inputs, 2) + "00";
}

/// Processes a frame. Returns no value if there is no reply. `frame`: the characters from the delimiter to
/// the last one before CR. `spoiled`: a byte of the frame had a line error. The tallies of received frames
/// count a request before it is executed. If the request reads such a tally, the value therefore includes
/// this request.
std::optional<std::string> Module::dcon_frame(std::string frame, bool spoiled) {
  if (spoiled) {
    count(&Counts::crc_errors);
    return std::nullopt;
  }
  // wire.md 3: a frame has at most 32 characters before CR.
  if (frame.size() > 32) {
    count(&Counts::crc_errors);
    return std::nullopt;
  }
  // CHK follows all other characters. If it is wrong or missing, there is no reply.
  if (checksum_) {
    if (frame.size() < 3) {
      count(&Counts::crc_errors);
      return std::nullopt;
    }
    const std::string check = frame.substr(frame.size() - 2);
    frame.resize(frame.size() - 2);
    if (check != check_of(frame)) {
      count(&Counts::crc_errors);
      return std::nullopt;
    }
  }
  count(&Counts::bus_messages);
  if (frame.size() < 3) {
    return std::nullopt;
  }
  const std::string address = frame.substr(1, 2);
  if (address == "**") {
    // Broadcasts never get a reply.
    count(&Counts::server_messages);
    counts_.no_response += 1;
    if (frame == "#**") {
      take_sample();
    } else if (frame == "~**") {
      restart_host_watchdog();
    }
    return std::nullopt;
  }
  if (address != aa()) {
    counts_.no_response += 1;  // the address was right when the frame was complete: wire.md D16
    return std::nullopt;
  }
  count(&Counts::server_messages);
  own_ = true;
  std::string reply;
  try {
    reply = dcon_command(frame[0], frame.substr(3));
  } catch (const Refused& refused) {
    counts_.exceptions += 1;
    refusal_ = refused.reason;
    reply = refused.bare ? "?" : "?" + aa();
  }
  return reply + (checksum_ ? check_of(reply) : "") + "\r";
}

std::string Module::dcon_command(char delimiter, const std::string& body) {
  switch (delimiter) {
    case '%':
      return set_configuration(body);
    case '#':
      return hash_command(body);
    case '$':
      return dollar_command(body);
    case '@':
      return at_command(body);
    default:
      return tilde_command(body);
  }
}

/// Executes `%AANNTTCCFF`.
std::string Module::set_configuration(const std::string& body) {
  const std::optional<unsigned> all = number(body);
  if (body.size() != 8 || !all) {
    throw Refused{"%AANNTTCCFF with a wrong form"};
  }
  const unsigned address = *all >> 24 & 0xFFU;
  const unsigned type = *all >> 16 & 0xFFU;
  const unsigned baud_code = *all >> 8 & 0xFFU;
  const unsigned format = *all & 0xFFU;
  if (type != 0x40 && type != 0x24) {  // wire.md E1
    throw Refused{"%AANNTTCCFF TT out of range"};
  }
  if (!baud_code_exists(baud_code)) {
    throw Refused{baud_code < 0x40 ? "%AANNTTCCFF CC out of range"
                                   : "%AANNTTCCFF CC with a line format out of range"};
  }
  if ((format & 0x3FU) != 0) {
    throw Refused{"%AANNTTCCFF FF out of range"};
  }
  // For a module whose stored protocol is Modbus, NN must be 01-F7.
  if (stored_.modbus && (address < 0x01 || address > 0xF7)) {
    throw Refused{"%AANNTTCCFF NN out of range"};
  }
  const bool checksum_differs = ((format ^ stored_.format) & 0x40U) != 0;
  if ((baud_code != stored_.baud_code || checksum_differs) && !permission()) {
    throw Refused{format_of(baud_code) != format_of(stored_.baud_code)
                      ? "%AANNTTCCFF without permission for another line format"
                      : "%AANNTTCCFF without permission"};
  }
  set().address = address;
  set().baud_code = baud_code;
  set().format = format;
  // The new address is in force immediately. In INIT mode the module uses address 00 until reset.
  if (!init_mode_) {
    address_ = address;
  }
  return "!" + hex(address, 2);
}

void Module::take_sample() { sample_ = Sample{first_second(outputs_, levels_), false}; }

std::string Module::hash_command(const std::string& body) {
  const bool one_character = body.size() == 1;
  // wire.md 3: on a model with inputs and outputs, `#AA` and one character is `#AAN`.
  if (row_->outputs != 0 && !(row_->inputs != 0 && one_character)) {
    return set_group_or_single(body);
  }
  const std::optional<unsigned> channel = number(body);
  if (!one_character || !channel || *channel >= row_->inputs) {
    throw Refused{"#AAN refused"};
  }
  std::string digits = std::to_string(counters_[*channel]);
  digits.insert(0, 5 - digits.size(), '0');
  return "!" + aa() + digits;
}

/// Executes `#AABBDD`.
std::string Module::set_group_or_single(const std::string& body) {
  const std::optional<unsigned> all = number(body);
  if (body.size() != 4 || !all) {
    throw Refused{"#AABBDD with a wrong form", true};
  }
  const unsigned group = *all >> 8;
  const unsigned data = *all & 0xFFU;
  unsigned channels = 0;
  unsigned wanted = 0;
  std::string reached;
  if (group == 0x00 || group == 0x0A || group == 0x0B) {
    const unsigned shift = group == 0x0B ? 8 : 0;
    const unsigned mask = (0xFFU << shift) & all_outputs();
    if (mask == 0) {
      throw Refused{"#AABBDD group that the model does not have", true};
    }
    if ((data << shift & ~mask) != 0) {
      throw Refused{"#AABBDD group's data beyond its channels", true};  // wire.md E2
    }
    channels = mask;
    wanted = data << shift;
    reached = "#AABBDD group " + hex(group, 2);
  } else {
    const unsigned lead = group >> 4;
    const unsigned digit = group & 0xFU;
    if (lead != 0x1 && lead != 0xA && lead != 0xB) {
      throw Refused{"#AABBDD BB out of range", true};
    }
    const unsigned channel = digit + (lead == 0xB ? 8 : 0);
    if (digit > 7 || channel >= row_->outputs) {
      throw Refused{"#AABBDD channel that the model does not have", true};
    }
    if (data > 0x01) {
      throw Refused{"#AABBDD single DD out of range", true};
    }
    channels = 1U << channel;
    wanted = data << channel;
    reached = "#AABBDD single " + hex(lead, 1) + "c";
  }
  // wire.md 6: the module checks format and range first, then the timeout status.
  if (refuses_outputs()) {
    return "!";
  }
  drive(channels, wanted);
  return ">";
}

std::string Module::dollar_command(const std::string& body) {
  if (body == "2") {
    return "!" + hex(stored_.address, 2) + "40" + hex(stored_.baud_code, 2) + hex(stored_.format, 2);
  }
  if (body == "4") {
    if (!sample_) {
      throw Refused{"$AA4 without a sample"};
    }
    const std::string first_time = sample_->read ? "0" : "1";
    sample_->read = true;
    return "!" + first_time + sample_->first_second + "00";
  }
  if (body == "5") {
    const std::string status = reset_status_ ? "1" : "0";
    reset_status_ = false;
    return "!" + aa() + status;
  }
  if (body == "6") {
    return "!" + first_second(outputs_, levels_) + "00";
  }
  if (body == "F") {
    return "!" + aa() + version_text();
  }
  if (body == "M") {
    return "!" + aa() + stored_.name;
  }
  if (!body.empty() && body[0] == 'C') {
    if (row_->inputs == 0) {
      throw Refused{"$AAC on a model without inputs"};
    }
    if (body == "C") {
      clear_latches();
      return "!" + aa();
    }
    const std::optional<unsigned> channel = number(body.substr(1));
    if (body.size() != 2 || !channel || *channel >= row_->inputs) {
      throw Refused{"$AACN refused"};
    }
    clear_counter(*channel);
    return "!" + aa();
  }
  if (!body.empty() && body[0] == 'L') {
    if (row_->inputs == 0) {
      throw Refused{"$AALS on a model without inputs"};
    }
    if (body != "L0" && body != "L1") {
      throw Refused{"$AALS refused"};
    }
    return "!" + first_second(0, body == "L1" ? latch_high_ : latch_low_) + "00";
  }
  if (!body.empty() && body[0] == 'P') {
    if (!row_->both_protocols) {
      throw Refused{"$AAP on a model without Modbus"};
    }
    if (body == "P") {
      return "!" + aa() + (stored_.modbus ? "11" : "10");
    }
    return set_protocol(body.substr(1));
  }
  throw Refused{"$ unknown command"};
}

/// Executes `$AAPN`.
std::string Module::set_protocol(const std::string& body) {
  if (body != "0" && body != "1") {
    throw Refused{"$AAPN out of range"};
  }
  if (!permission()) {
    throw Refused{"$AAPN without permission"};
  }
  if (body == "1" && (stored_.address < 0x01 || stored_.address > 0xF7)) {
    throw Refused{"$AAPN 1 with a stored address outside 01-F7"};
  }
  set().modbus = body == "1";
  return "!" + aa();
}

std::string Module::at_command(const std::string& body) {
  if (body.empty()) {
    return ">" + first_second(outputs_, levels_);
  }
  if (row_->outputs == 0) {
    throw Refused{"@AA(Data) on a model without outputs"};
  }
  const std::size_t longest = row_->outputs <= 4 ? 1 : row_->outputs <= 8 ? 2 : 4;
  const std::size_t shorter = longest == 1 ? 1 : longest / 2;  // wire.md E4
  const std::optional<unsigned> data = number(body);
  if ((body.size() != longest && body.size() != shorter) || !data) {
    throw Refused{"@AA(Data) with a wrong form", true};
  }
  if ((*data & ~all_outputs()) != 0) {
    throw Refused{"@AA(Data) beyond the last channel", true};
  }
  if (refuses_outputs()) {
    return "!";
  }
  drive(all_outputs(), *data);
  return ">";
}

std::string Module::tilde_command(const std::string& body) {
  if (body == "0") {
    // wire.md E7
    const bool on = row_->status_80_84;
    const std::string status = stored_.timed_out ? (on ? "84" : "04") : (on && stored_.enabled ? "80" : "00");
    return "!" + aa() + status;
  }
  if (body == "1") {
    clear_timeout_status();
    return "!" + aa();
  }
  if (body == "2") {
    return "!" + aa() + (stored_.enabled ? "1" : "0") + hex(stored_.timeout, 2);
  }
  const char command = body.empty() ? ' ' : body[0];
  const std::string argument = body.empty() ? "" : body.substr(1);
  if (command == '3') {
    return set_host_watchdog(argument);
  }
  if (command == '4' || command == '5') {
    const std::string name = std::string("~AA") + command + "V";
    if (row_->outputs == 0) {
      throw Refused{name + " on a model without outputs"};
    }
    if (argument != "P" && argument != "S") {
      throw Refused{name + " refused"};
    }
    unsigned Stored::*const value = argument == "P" ? &Stored::power_on : &Stored::safe;
    if (command == '5') {
      // wire.md 6: `~AA5V` works while the timeout status is set, because it drives nothing.
      set().*value = overtaken_.value_or(lasting_outputs());
      return "!" + aa();
    }
    // wire.md 4: the reply contains no inputs, even on a model with inputs and outputs.
    return "!" + aa() + first_second(stored_.*value, 0);
  }
  if (command == 'O') {
    const bool characters = std::all_of(argument.begin(), argument.end(), [](char character) {
      return character >= 0x20 && character <= 0x7E;
    });
    if (argument.empty() || argument.size() > row_->longest_name) {
      throw Refused{"~AAO(Data) with a wrong length"};
    }
    if (!characters) {
      throw Refused{"~AAO(Data) with a character outside 0x20-0x7E"};
    }
    set().name = argument;
    return "!" + aa();
  }
  if (command == 'R') {
    return delay_command(argument);
  }
  if (command == 'X') {
    return extension_command(argument);
  }
  throw Refused{"~ unknown command"};
}

/// Executes `~AA3EVV`.
std::string Module::set_host_watchdog(const std::string& body) {
  const std::optional<unsigned> timeout = number(body.size() == 3 ? body.substr(1) : "");
  if (!timeout || (body[0] != '0' && body[0] != '1')) {
    throw Refused{"~AA3EVV with a wrong form"};
  }
  if (*timeout == 0) {
    throw Refused{"~AA3EVV VV out of range"};
  }
  const bool enable = body[0] == '1';
  set().enabled = enable;
  set().timeout = *timeout;
  restart_host_watchdog();
  return "!" + aa();
}

}  // namespace ex9000::reference
