// The commands that firmware/extensions.md adds: `~AAX` and `~AARD`.
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"
#include "firmware/registers/find.hpp"

namespace ex9000::dcon {

namespace {

using registers::WordRow;

constexpr std::uint8_t kDelayKey = 'D';  // the character after `~AAR`

/// Four upper-case hex digits from `args[at]` on; else -1.
int hex_word(Bytes args, std::size_t at) {
  constexpr int kByte = 0x100;
  const int high = hex_byte(args[at], args[at + 1]);
  const int low = hex_byte(args[at + 2], args[at + 3]);
  return high < 0 || low < 0 ? -1 : high * kByte + low;
}

/// Null if `address` is negative or the model has no such extension register.
const WordRow* row_of(const Model& model, int address) {
  return address < 0 ? nullptr : registers::find_extension(model, static_cast<unsigned>(address));
}

}  // namespace

Refusal read_extension(Exchange& exchange) {
  const int address = hex_word(exchange.args, 0);
  const WordRow* row = row_of(exchange.model(), address);
  if (row == nullptr) {
    return Refusal::OutOfRange;
  }
  const unsigned index = static_cast<unsigned>(address) - row->first;
  const bool is_long = row->has(registers::kLong);
  if (is_long && index % 2 != 0) {
    // Never the low word alone: two reads could return words of two different values.
    return Refusal::OutOfRange;
  }
  put_valid(exchange);
  put_hex_word(exchange.reply, row->read(exchange, index));
  if (is_long) {
    put_hex_word(exchange.reply, row->read(exchange, index + 1));
  }
  return Refusal::None;
}

Refusal write_extension(Exchange& exchange) {
  constexpr std::size_t kValueAt = 4;
  const int address = hex_word(exchange.args, 0);
  const int value = hex_word(exchange.args, kValueAt);
  const WordRow* row = row_of(exchange.model(), address);
  if (row == nullptr || row->write == nullptr || value < 0) {
    return Refusal::OutOfRange;
  }
  put_valid(exchange);
  return row->write(exchange.state, static_cast<unsigned>(address) - row->first,
                    static_cast<std::uint16_t>(value), exchange.outcome);
}

Refusal read_response_delay(Exchange& exchange) {
  if (exchange.args[0] != kDelayKey) {
    return Refusal::UnknownCommand;
  }
  put_valid(exchange);
  exchange.reply.put_hex(exchange.state.settings.response_delay);
  return Refusal::None;
}

Refusal set_response_delay(Exchange& exchange) {
  const int delay = hex_byte(exchange.args[1], exchange.args[2]);
  if (exchange.args[0] != kDelayKey) {
    return Refusal::UnknownCommand;
  }
  if (delay < 0) {
    return Refusal::OutOfRange;
  }
  exchange.outcome.change().response_delay = static_cast<std::uint8_t>(delay);
  put_valid(exchange);
  return Refusal::None;
}

}  // namespace ex9000::dcon
