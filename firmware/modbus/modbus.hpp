// Replies to Modbus RTU requests - wire.md section 7.
#pragma once

#include "firmware/request/exchange.hpp"

namespace ex9000::modbus {

/// Judges the frame and writes the outcome and the whole reply with CRC, which is empty for a broadcast;
/// changes nothing else. The module must carry out the outcome before it sends the reply.
void answer(Exchange& exchange);

/// For a refusal that is known only later, in the outcome: the reply becomes an exception, unless it is empty
/// (broadcast).
void refuse(Exchange& exchange);

}  // namespace ex9000::modbus
