// The format of Modbus replies: an independent implementation of wire.md 7.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "tests/oracles/judges/reply_form.hpp"

namespace ex9000::judges {

namespace detail {

inline bool begins_like(Bytes reply, Bytes request, std::size_t bytes) {
  return reply.size >= bytes && request.size >= bytes &&
         std::equal(reply.begin(), reply.begin() + bytes, request.begin());
}

/// Returns whether the request has a permitted length and quantity, and the reply has the form for functions
/// 01 and 02: the byte count and the bits. Unused bits of the last byte must be 0.
inline bool are_bits(Bytes request, Bytes reply) {
  if (request.size != 6) {
    return false;
  }
  const unsigned bits = request.word(4);
  const std::size_t bytes = (bits + 7) / 8;
  return bits >= 1 && bits <= 2000 && reply.size == 3 + bytes && reply[2] == bytes &&
         (bits % 8 == 0 || reply[reply.size - 1] >> bits % 8 == 0);
}

inline bool are_registers(Bytes request, Bytes reply) {
  if (request.size != 6) {
    return false;
  }
  const unsigned registers = request.word(4);
  return registers >= 1 && registers <= 125 && reply.size == 3 + 2 * registers && reply[2] == 2 * registers;
}

inline bool is_diagnosis(Bytes request, Bytes reply) {
  if (request.size < 6 || request.size % 2 != 0) {
    return false;
  }
  const unsigned sub = request.word(2);
  if (sub == 0x00) {
    return reply.size == request.size && begins_like(reply, request, request.size);
  }
  const bool known = sub == 0x12 || (sub >= 0x0A && sub <= 0x0F);
  return known && request.size == 6 && request.word(4) == 0 && reply.size == 6 &&
         begins_like(reply, request, 4);
}

/// Returns whether the reply has the form for function 11: the byte count, the module code, FF and the name.
inline bool is_server_id(Bytes reply) {
  return reply.size >= 7 && reply.size <= 13 && reply[2] == reply.size - 3 && reply[3] == 0x90 &&
         reply[5] == 0xFF;
}

/// Returns whether the request has the right length and MEI type 0E, and the reply has the form for function
/// 2B: MEI type, code, conformity level, "more follows", next object and number of objects, and then id,
/// length and text of each object.
inline bool is_identification(Bytes request, Bytes reply) {
  if (request.size != 5 || reply.size < 8 || !begins_like(reply, request, 4) || request[2] != 0x0E ||
      reply[4] != 0x82 || reply[5] != 0 || reply[6] != 0 || reply[7] == 0) {
    return false;
  }
  std::size_t at = 8;
  for (unsigned object = 0; object < reply[7]; ++object) {
    if (at + 2 > reply.size || at + 2 + reply[at + 1] > reply.size) {
      return false;
    }
    at += 2U + reply[at + 1];
  }
  return at == reply.size;
}

inline bool is_of_function_46(Bytes request, Bytes reply) {
  if (reply.size != 7 || !begins_like(reply, request, 3)) {
    return false;
  }
  if (request[2] == 0x00) {
    return request.size == 3 && reply[3] == 0x00 && reply[4] == 0x90 && reply[6] == 0x00;
  }
  return request[2] == 0x04 && request.size == 7 && reply[3] == 0 && reply.word(4) == 0 && reply[6] == 0;
}

inline bool is_answer(Bytes request, Bytes reply) {
  switch (request[1]) {
    case 0x01:
    case 0x02:
      return are_bits(request, reply);
    case 0x03:
    case 0x04:
      return are_registers(request, reply);
    case 0x05:
    case 0x06:
      return request.size == 6 && reply.size == 6 && begins_like(reply, request, 6);
    case 0x08:
      return is_diagnosis(request, reply);
    case 0x0F:
    case 0x10:
      return reply.size == 6 && begins_like(reply, request, 6);
    case 0x11:
      return request.size == 2 && is_server_id(reply);
    case 0x2B:
      return is_identification(request, reply);
    case 0x46:
      return is_of_function_46(request, reply);
    default:
      return false;
  }
}

}  // namespace detail

/// Returns how `reply` relates to `request`. Neither includes a CRC. The request has at least address and
/// function.
inline ReplyForm rtu_reply_form(Bytes request, Bytes reply) {
  if (reply.size < 3 || reply[0] != request[0]) {
    return ReplyForm::Wrong;
  }
  if (reply[1] == (request[1] | 0x80U) && reply.size == 3 && reply[2] >= 1 && reply[2] <= 4) {
    return ReplyForm::Refusal;
  }
  return reply[1] == request[1] && detail::is_answer(request, reply) ? ReplyForm::Answer : ReplyForm::Wrong;
}

}  // namespace ex9000::judges
