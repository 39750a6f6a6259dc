#include "sim/utility/modbus/request.hpp"

namespace ex9000::utility {

namespace {

Data pdu_of(std::uint8_t function, unsigned address, unsigned value) {
  Data pdu{function};
  append_word(pdu, address);
  append_word(pdu, value);
  return pdu;
}

Request read(std::uint8_t function, unsigned address, unsigned count, std::size_t bytes) {
  return {pdu_of(function, address, count), {function, static_cast<std::uint8_t>(bytes)}, 2 + bytes};
}

Request echoed(const Data& pdu) { return {pdu, pdu, pdu.size()}; }

}  // namespace

void append_word(Data& data, unsigned value) {
  data.push_back(static_cast<std::uint8_t>(value >> 8U));
  data.push_back(static_cast<std::uint8_t>(value));
}

Request read_words(unsigned address, unsigned count, std::uint8_t function) {
  return read(function, address, count, std::size_t{2} * count);
}

Request read_bits(unsigned address, unsigned count, std::uint8_t function) {
  constexpr unsigned kBits = 8;
  return read(function, address, count, (count + kBits - 1) / kBits);
}

Request write_word(unsigned address, std::uint16_t value) { return echoed(pdu_of(0x06, address, value)); }

Request write_bit(unsigned address, bool on) { return echoed(pdu_of(0x05, address, on ? 0xFF00 : 0)); }

Request write_words(unsigned address, Bytes data) {
  Request request = echoed(pdu_of(0x10, address, static_cast<unsigned>(data.size / 2)));
  request.pdu.push_back(static_cast<std::uint8_t>(data.size));
  request.pdu.insert(request.pdu.end(), data.begin(), data.end());
  return request;
}

}  // namespace ex9000::utility
