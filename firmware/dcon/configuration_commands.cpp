// Commands for configuration, reset status, name, protocol and version: manuals 2.1, 2.4, 2.6, 2.8, 2.9, 2.12
// to 2.14 (EX9052D 2.14 to 2.16).
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"

namespace ex9000::dcon {

namespace {

constexpr int kDioType = 0x40;
constexpr int kDioTypeOfTheExample = 0x24;  // wire.md E1

}  // namespace

Refusal set_configuration(Exchange& exchange) {
  const int address = hex_byte(exchange.args[0], exchange.args[1]);
  const int type = hex_byte(exchange.args[2], exchange.args[3]);
  const int baud_code = hex_byte(exchange.args[4], exchange.args[5]);
  const int format = hex_byte(exchange.args[6], exchange.args[7]);
  if (address < 0 || baud_code < 0 || format < 0 || (type != kDioType && type != kDioTypeOfTheExample)) {
    return Refusal::OutOfRange;
  }
  const Settings& settings = exchange.state.settings;
  const auto new_address = static_cast<std::uint8_t>(address);
  const auto new_baud_code = static_cast<std::uint8_t>(baud_code);
  const auto new_format = static_cast<std::uint8_t>(format);
  if (!is_baud_code(new_baud_code) || (new_format & ~kFormatMask) != 0 ||
      (settings.protocol == Protocol::ModbusRtu && !is_modbus_address(new_address))) {
    return Refusal::OutOfRange;
  }
  const bool changes_line =
      new_baud_code != settings.baud_code || ((new_format ^ settings.format) & kFormatChecksum) != 0;
  if (changes_line && !exchange.state.configuration_permitted()) {
    return Refusal::NotPermitted;
  }
  SettingsChange& change = exchange.outcome.change();
  change.address = new_address;
  change.baud_code = new_baud_code;
  change.format = new_format;
  if (!exchange.state.in_force.init_mode) {
    exchange.outcome.request(Effect::TakeAddress);
  }
  exchange.reply.put('!');
  exchange.reply.put_hex(new_address);
  return Refusal::None;
}

Refusal read_configuration(Exchange& exchange) {
  // The reply contains the stored address even in INIT mode, so that a user can find a lost address.
  exchange.reply.put('!');
  exchange.reply.put_hex(exchange.state.settings.address);
  exchange.reply.put_hex(kDioType);
  exchange.reply.put_hex(exchange.state.settings.baud_code);
  exchange.reply.put_hex(exchange.state.settings.format);
  return Refusal::None;
}

Refusal read_reset_status(Exchange& exchange) {
  exchange.outcome.request(Effect::ClearResetStatus);
  put_valid(exchange);
  exchange.reply.put(exchange.state.reset_status ? '1' : '0');
  return Refusal::None;
}

Refusal read_version(Exchange& exchange) {
  put_valid(exchange);
  exchange.reply.put(kFirmwareVersion);
  return Refusal::None;
}

Refusal read_name(Exchange& exchange) {
  put_valid(exchange);
  exchange.reply.put(exchange.state.settings.name.bytes());
  return Refusal::None;
}

Refusal set_name(Exchange& exchange) {
  if (exchange.args.size > exchange.model().longest_name) {
    return Refusal::OutOfRange;
  }
  for (const std::uint8_t character : exchange.args) {
    if (!Name::is_name_character(character)) {
      return Refusal::OutOfRange;
    }
  }
  exchange.outcome.change().name = Name(exchange.args);
  put_valid(exchange);
  return Refusal::None;
}

Refusal read_protocol(Exchange& exchange) {
  put_valid(exchange);
  exchange.reply.put('1');
  exchange.reply.put(exchange.state.settings.protocol == Protocol::ModbusRtu ? '1' : '0');
  return Refusal::None;
}

Refusal set_protocol(Exchange& exchange) {
  const bool modbus = exchange.args[0] == '1';
  if ((!modbus && exchange.args[0] != '0') ||
      (modbus && !is_modbus_address(exchange.state.settings.address))) {
    return Refusal::OutOfRange;
  }
  if (!exchange.state.configuration_permitted()) {
    return Refusal::NotPermitted;
  }
  exchange.outcome.change().protocol = modbus ? Protocol::ModbusRtu : Protocol::Ascii;
  put_valid(exchange);
  return Refusal::None;
}

}  // namespace ex9000::dcon
