// Functions 05, 06, 0F, 10: Modbus Application Protocol V1.1b3, 6.5, 6.6, 6.11, 6.12. Checks in this order:
// length and quantity, address, value, Exchange::judge_outcome; function 05 checks FF00 or 0000 before the
// address. A request that fails a check changes nothing.
#include "firmware/modbus/functions.hpp"
#include "firmware/registers/find.hpp"

namespace ex9000::modbus {

namespace {

using namespace registers;

constexpr std::size_t kSingleSize = 6;
constexpr std::size_t kMultipleHeader = 7;
constexpr unsigned kMostCoils = 1968;
constexpr unsigned kMostRegisters = 123;
constexpr std::uint16_t kCoilOn = 0xFF00;
constexpr std::uint16_t kCoilOff = 0x0000;

/// Bytes 2 to 5 of the request: the address, and the value or the quantity.
void put_echo(Exchange& exchange) { exchange.reply.put(exchange.frame.first(kSingleSize).from(2)); }

Refusal write_bits(Exchange& exchange, const BitRow& row, BitWrite bits) {
  if (exchange.broadcast && row.has(kConfiguration)) {
    return Refusal::None;  // ignored, because one frame must not reconfigure all modules
  }
  put_echo(exchange);
  return row.write(exchange.state, bits, exchange.outcome);
}

Refusal write_word(Exchange& exchange, const WordRow& row, unsigned address, std::uint16_t value) {
  return row.write(exchange.state, address - row.first, value, exchange.outcome);
}

/// For functions 0F and 10. `most`: largest quantity; `bits`: bits per value.
Refusal check_multiple(Bytes frame, unsigned most, unsigned bits) {
  if (frame.size < kMultipleHeader) {
    return Refusal::WrongLength;
  }
  const unsigned quantity = frame.word(4);
  if (quantity == 0 || quantity > most) {
    return Refusal::WrongQuantity;
  }
  const unsigned data = (quantity * bits + 7) / 8;
  return frame[6] == data && frame.size == kMultipleHeader + data ? Refusal::None : Refusal::WrongLength;
}

}  // namespace

Refusal write_single_coil(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  if (frame.size != kSingleSize) {
    return Refusal::WrongLength;
  }
  const std::uint16_t address = frame.word(2);
  const std::uint16_t value = frame.word(4);
  if (value != kCoilOn && value != kCoilOff) {
    return Refusal::WrongCoilValue;
  }
  const BitRow* row = find_bits(exchange.model(), kWriteSingleCoil, address, 1);
  if (row == nullptr) {
    return Refusal::WrongAddress;
  }
  if (row->has(kOnlyOn) && value != kCoilOn) {
    return Refusal::WrongValue;
  }
  const auto bit = static_cast<std::uint16_t>(1U << (unsigned{address} - row->first));
  return write_bits(exchange, *row, {bit, value == kCoilOn ? bit : std::uint16_t{0}});
}

Refusal write_multiple_coils(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  const Refusal refusal = check_multiple(frame, kMostCoils, 1);
  if (refusal != Refusal::None) {
    return refusal;
  }
  const std::uint16_t start = frame.word(2);
  const unsigned quantity = frame.word(4);
  const BitRow* row = find_bits(exchange.model(), kWriteMultipleCoils, start, quantity);
  if (row == nullptr) {
    return Refusal::WrongAddress;
  }
  const unsigned index = unsigned{start} - row->first;
  const unsigned mask = (1U << quantity) - 1U;
  const unsigned values =
      frame[kMultipleHeader] | (quantity > 8 ? unsigned{frame[kMultipleHeader + 1U]} << 8U : 0U);
  return write_bits(
      exchange, *row,
      {static_cast<std::uint16_t>(mask << index), static_cast<std::uint16_t>((values & mask) << index)});
}

Refusal write_single_register(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  if (frame.size != kSingleSize) {
    return Refusal::WrongLength;
  }
  const std::uint16_t address = frame.word(2);
  const WordRow* row = find_word(exchange.model(), kWriteRegisters, address);
  if (row == nullptr) {
    return Refusal::WrongAddress;
  }
  if (exchange.broadcast && row->has(kConfiguration)) {
    return Refusal::None;
  }
  put_echo(exchange);
  return write_word(exchange, *row, address, frame.word(4));
}

Refusal write_multiple_registers(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  const Refusal refusal = check_multiple(frame, kMostRegisters, 16);
  if (refusal != Refusal::None) {
    return refusal;
  }
  const unsigned start = frame.word(2);
  const unsigned quantity = frame.word(4);
  const WordRow* whole = kBuiltUpdate ? find_word(exchange.model(), kWriteWholeRow, start) : nullptr;
  if (whole != nullptr && whole->first == start && width_of(whole->width, exchange.model()) == quantity) {
    put_echo(exchange);
    return exchange.broadcast
               ? Refusal::None
               : whole->write_whole(exchange.state, frame.from(kMultipleHeader), exchange.outcome);
  }
  Refusal wrong_value = Refusal::None;
  bool configuration = false;
  for (unsigned i = 0; i < quantity; ++i) {
    const WordRow* row = find_word(exchange.model(), kWriteRegisters, start + i);
    if (row == nullptr) {
      return Refusal::WrongAddress;
    }
    configuration |= row->has(kConfiguration);
    if (wrong_value == Refusal::None) {
      wrong_value = write_word(exchange, *row, start + i, frame.word(kMultipleHeader + std::size_t{2} * i));
    }
  }
  if (exchange.broadcast && configuration) {
    exchange.outcome.clear();
    return Refusal::None;
  }
  put_echo(exchange);
  return wrong_value;
}

}  // namespace ex9000::modbus
