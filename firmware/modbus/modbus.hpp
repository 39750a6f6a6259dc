// Replies to Modbus RTU requests - wire.md section 7.
#pragma once

#include "firmware/request/exchange.hpp"

namespace ex9000::modbus {

/// Judges the frame of `exchange` and writes its outcome and its reply, including the CRC. The module must
/// carry out the outcome before it sends the reply. The reply is empty if the frame is a broadcast. Changes
/// nothing but `exchange`.
void answer(Exchange& exchange);

/// Replaces the reply with an exception. Call this if the settings could not be stored. The empty reply to a
/// broadcast stays empty.
void refuse_store(Exchange& exchange);

}  // namespace ex9000::modbus
