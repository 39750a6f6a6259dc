// Configuration, version, name and protocol: manuals 2.1, 2.4, 2.6, 2.8, 2.9, 2.12-2.14 (EX9052D 2.14-2.16).
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
  SettingsChange& change = exchange.outcome.change();
  change.address = static_cast<std::uint8_t>(address);
  change.baud_code = static_cast<std::uint8_t>(baud_code);
  change.format = static_cast<std::uint8_t>(format);
  if (!exchange.state.in_force.init_mode) {
    exchange.outcome.request(Effect::TakeAddress);
  }
  exchange.reply.put('!');
  exchange.reply.put_hex(*change.address);
  return Refusal::None;
}

Refusal read_configuration(Exchange& exchange) {
  // The stored address even in INIT mode, so that a user can find a lost one.
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
  exchange.reply.put(exchange.state.version.text());
  return Refusal::None;
}

Refusal read_name(Exchange& exchange) {
  put_valid(exchange);
  exchange.reply.put(exchange.state.settings.name.bytes());
  return Refusal::None;
}

Refusal set_name(Exchange& exchange) {
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
  if (!modbus && exchange.args[0] != '0') {
    return Refusal::OutOfRange;
  }
  exchange.outcome.change().protocol = modbus ? Protocol::ModbusRtu : Protocol::Ascii;
  put_valid(exchange);
  return Refusal::None;
}

}  // namespace ex9000::dcon
