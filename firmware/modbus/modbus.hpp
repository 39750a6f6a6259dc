// Answers Modbus RTU requests - wire.md section 7.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/request/outcome.hpp"
#include "firmware/request/reply.hpp"
#include "firmware/request/state.hpp"

namespace ex9000::modbus {

/// Judges an accepted frame (address, function, data, without CRC). `reply` is what to send, CRC included,
/// once the outcome is done; it stays empty for broadcasts. Changes nothing by itself.
void answer(const State& state, Bytes frame, Outcome& outcome, Reply& reply);

/// Makes `reply`, an answer to a request that could not be stored, an exception; a broadcast's stays empty.
void refuse_store(Reply& reply);

}  // namespace ex9000::modbus
