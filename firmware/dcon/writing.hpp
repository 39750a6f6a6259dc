// Writes words, channels and addresses into DCON replies.
#pragma once

#include <cstdint>

#include "firmware/request/exchange.hpp"

namespace ex9000::dcon {

inline void put_hex_word(Reply& reply, std::uint16_t value) {
  reply.put_hex(value >> 8U);
  reply.put_hex(value & 0xFFU);
}

/// First and Second, the data bytes (manuals 1.10): with more than 8 outputs or inputs, their high and low
/// byte; else the outputs and the inputs; without outputs, the inputs and 00.
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

/// `!AA`, the beginning of most replies. AA is the address in force, 00 in INIT mode.
inline void put_valid(Exchange& exchange) {
  exchange.reply.put('!');
  exchange.reply.put_hex(exchange.state.in_force.address);
}

}  // namespace ex9000::dcon
