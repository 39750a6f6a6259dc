// Answers Modbus RTU requests - wire.md section 7.
#pragma once

#include "firmware/request/exchange.hpp"

namespace ex9000::modbus {

/// Judges an accepted frame. The reply is what to send, CRC included, once the outcome is done; it stays
/// empty for broadcasts. Changes nothing by itself.
void answer(Exchange& exchange);

/// Makes a reply to a request that could not be stored an exception; a broadcast's stays empty.
void refuse_store(Exchange& exchange);

}  // namespace ex9000::modbus
