// Functions of the reference that read words of Modbus frames, build frames and refuse requests: wire.md 7.
#pragma once

#include <cstdint>
#include <string>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

/// A Modbus exception: the module refuses the request and executes no part of it. The reply has the function
/// code with bit 7 set, and the exception code. A broadcast gets no reply.
struct Exception {
  std::uint8_t code;
  std::string reason;
};

inline unsigned word(const Bytes& frame, std::size_t at) { return frame[at] * 256U + frame[at + 1]; }

inline void append_word(Bytes& frame, unsigned value) {
  frame.push_back(static_cast<std::uint8_t>(value >> 8 & 0xFFU));
  frame.push_back(static_cast<std::uint8_t>(value & 0xFFU));
}

inline void append_text(Bytes& frame, const std::string& text) {
  frame.insert(frame.end(), text.begin(), text.end());
}

inline std::string function_name(unsigned function) { return "FC" + hex(function, 2); }

/// Throws Exception 03 unless the frame, without its CRC, has this length.
inline void length_must_be(const Bytes& frame, std::size_t length) {
  if (frame.size() != length) {
    throw Exception{0x03, function_name(frame[1]) + " 03 length"};
  }
}

inline void quantity_must_be(unsigned quantity, unsigned highest, unsigned function) {
  if (quantity == 0 || quantity > highest) {
    throw Exception{0x03, function_name(function) + " 03 quantity"};
  }
}

}  // namespace ex9000::reference
