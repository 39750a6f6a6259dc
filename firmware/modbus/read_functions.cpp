// Functions 01 to 04: Modbus Application Protocol V1.1b3, 6.1 to 6.4.
#include "firmware/modbus/functions.hpp"
#include "firmware/registers/find.hpp"

namespace ex9000::modbus {

namespace {

using namespace registers;

constexpr std::size_t kRequestSize = 6;
constexpr unsigned kMostBits = 2000;
constexpr unsigned kMostWords = 125;

Functions function_of(Bytes frame) { return static_cast<Functions>(1U << frame[1]); }

}  // namespace

Refusal read_bits(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  if (frame.size != kRequestSize) {
    return Refusal::WrongLength;
  }
  const std::uint16_t start = frame.word(2);
  const unsigned quantity = frame.word(4);
  if (quantity == 0 || quantity > kMostBits) {
    return Refusal::WrongQuantity;
  }
  const BitRow* row = find_bits(exchange.model(), function_of(frame), start, quantity);
  if (row == nullptr) {
    return Refusal::WrongAddress;
  }
  const unsigned index = unsigned{start} - row->first;
  const unsigned bits = (unsigned{row->read(exchange.state)} >> index) & ((1U << quantity) - 1U);
  const unsigned bytes = quantity > 8 ? 2 : 1;
  exchange.reply.put(static_cast<std::uint8_t>(bytes));
  for (unsigned byte = 0; byte < bytes; ++byte) {
    exchange.reply.put(static_cast<std::uint8_t>(bits >> (8 * byte)));
  }
  return Refusal::None;
}

Refusal read_words(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  if (frame.size != kRequestSize) {
    return Refusal::WrongLength;
  }
  const std::uint16_t start = frame.word(2);
  const unsigned quantity = frame.word(4);
  if (quantity == 0 || quantity > kMostWords) {
    return Refusal::WrongQuantity;
  }
  exchange.reply.put(static_cast<std::uint8_t>(2 * quantity));
  const unsigned end = start + quantity;
  for (unsigned address = start; address < end;) {
    const WordRow* row = find_word(exchange.model(), function_of(frame), address);
    if (row == nullptr) {
      return Refusal::WrongAddress;
    }
    const unsigned end_of_row = row->first + width_of(row->width, exchange.model());
    for (; address < end && address < end_of_row; ++address) {
      exchange.reply.put_word(row->read(exchange, address - row->first));
    }
  }
  return Refusal::None;
}

}  // namespace ex9000::modbus
