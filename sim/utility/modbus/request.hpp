// A Modbus request, and how its reply begins.
#pragma once

#include <cstddef>
#include <utility>

#include "firmware/bytes.hpp"
#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

constexpr std::uint8_t kExceptionBit = 0x80;

struct Request {
  Data pdu;
  Data reply;  ///< with what the PDU of the reply begins
  std::size_t reply_size =
      0;  ///< of the whole PDU; 0: the byte after `reply` counts the rest, Modbus TCP: any
};

/// `function`: 3 or 4; `read_bits`: 1 or 2.
Request read_words(unsigned address, unsigned count, std::uint8_t function = 3);
Request read_bits(unsigned address, unsigned count, std::uint8_t function = 1);
Request write_word(unsigned address, std::uint16_t value);
Request write_bit(unsigned address, bool on);
/// `data`: an even number of bytes, high byte first.
Request write_words(unsigned address, Bytes data);

/// Function 11: code, FF, and the name.
inline Request report_server_id() { return {{0x11}, {0x11}, 0}; }
inline Request any_reply(Data pdu) { return {std::move(pdu), {}, 0}; }

/// Big-endian.
void append_word(Data& data, unsigned value);

}  // namespace ex9000::utility
