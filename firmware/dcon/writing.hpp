// Writes words, channels and addresses into DCON replies.
#pragma once

#include <cstdint>

#include "firmware/request/exchange.hpp"

namespace ex9000::dcon {

/// Writes the four hex digits of `value`.
inline void put_hex_word(Reply& reply, std::uint16_t value) {
  reply.put_hex(value >> 8U);
  reply.put_hex(value & 0xFFU);
}

/// Writes First and Second, the two data bytes of a reply (manuals 1.10). On a model with more than 8 outputs
/// or more than 8 inputs, First contains the high byte of these channels, and Second contains their low byte.
/// On a model with 1 to 8 outputs and at most 8 inputs, First contains the outputs, and Second contains the
/// inputs. On a model without outputs and with at most 8 inputs, First contains the inputs, and Second is 00.
inline void put_data(const Model& model, std::uint16_t outputs, std::uint16_t inputs, Reply& reply) {
  constexpr unsigned kChannelsOfAByte = 8;
  if (model.outputs > kChannelsOfAByte || model.inputs > kChannelsOfAByte) {
    put_hex_word(reply, model.has_outputs() ? outputs : inputs);
  } else if (model.has_outputs()) {
    reply.put_hex(outputs);
    reply.put_hex(inputs);
  } else {
    reply.put_hex(inputs);
    reply.put_hex(0);
  }
}

inline void put_data(Exchange& exchange, std::uint16_t outputs, std::uint16_t inputs) {
  put_data(exchange.model(), outputs, inputs, exchange.reply);
}

/// Writes `!AA`, the beginning of most replies. AA is the address in force, which is 00 in INIT mode.
inline void put_valid(Exchange& exchange) {
  exchange.reply.put('!');
  exchange.reply.put_hex(exchange.state.in_force.address);
}

}  // namespace ex9000::dcon
