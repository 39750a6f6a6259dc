// Configuration, name, protocol, version: manuals 2.1, 2.4, 2.6, 2.8, 2.9, 2.12 to 2.14.
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"

namespace ex9000::dcon {

namespace {

constexpr int kDioType = 0x40;
constexpr int kDioTypeOfTheExample = 0x24;  // E1

}  // namespace

Refusal set_configuration(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  const int address = hex_byte(args[0], args[1]);
  const int type = hex_byte(args[2], args[3]);
  const int baud_code = hex_byte(args[4], args[5]);
  const int format = hex_byte(args[6], args[7]);
  if (address < 0 || baud_code < 0 || format < 0 || (type != kDioType && type != kDioTypeOfTheExample)) {
    return Refusal::OutOfRange;
  }
  const Settings& settings = state.settings;
  const auto new_address = static_cast<std::uint8_t>(address);
  const auto new_baud_code = static_cast<std::uint8_t>(baud_code);
  const auto new_format = static_cast<std::uint8_t>(format);
  if (!is_baud_code(new_baud_code) || (new_format & ~kFormatMask) != 0 ||
      (settings.protocol == Protocol::ModbusRtu && !is_modbus_address(new_address))) {
    return Refusal::OutOfRange;
  }
  const bool changes_line =
      new_baud_code != settings.baud_code || ((new_format ^ settings.format) & kFormatChecksum) != 0;
  if (changes_line && !state.configuration_permitted()) {
    return Refusal::NotPermitted;
  }
  outcome.change.address(new_address).baud_code(new_baud_code).format(new_format);
  outcome.take_address = !state.in_force.init_mode;
  reply.put('!');
  reply.put_hex(new_address);
  return Refusal::None;
}

Refusal read_configuration(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  // The stored address, in INIT mode too: this is how a lost one is found.
  reply.put('!');
  reply.put_hex(state.settings.address);
  reply.put_hex(kDioType);
  reply.put_hex(state.settings.baud_code);
  reply.put_hex(state.settings.format);
  return Refusal::None;
}

Refusal read_reset_status(const State& state, Bytes /*args*/, Outcome& outcome, Reply& reply) {
  outcome.reset_status_read = true;
  put_valid(state, reply);
  reply.put(state.reset_status ? '1' : '0');
  return Refusal::None;
}

Refusal read_version(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  put_valid(state, reply);
  reply.put(kFirmwareVersion);
  return Refusal::None;
}

Refusal read_name(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  put_valid(state, reply);
  reply.put(state.settings.name.bytes());
  return Refusal::None;
}

Refusal set_name(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  if (args.size > state.model().longest_name) {
    return Refusal::OutOfRange;
  }
  for (const std::uint8_t character : args) {
    if (!Name::is_name_character(character)) {
      return Refusal::OutOfRange;
    }
  }
  outcome.change.name(Name(args));
  put_valid(state, reply);
  return Refusal::None;
}

Refusal read_protocol(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  put_valid(state, reply);
  reply.put('1');
  reply.put(state.settings.protocol == Protocol::ModbusRtu ? '1' : '0');
  return Refusal::None;
}

Refusal set_protocol(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  const bool modbus = args[0] == '1';
  if ((!modbus && args[0] != '0') || (modbus && !is_modbus_address(state.settings.address))) {
    return Refusal::OutOfRange;
  }
  if (!state.configuration_permitted()) {
    return Refusal::NotPermitted;
  }
  outcome.change.protocol(modbus ? Protocol::ModbusRtu : Protocol::Ascii);
  put_valid(state, reply);
  return Refusal::None;
}

}  // namespace ex9000::dcon
