// Replies to Modbus RTU requests - wire.md section 7.
#pragma once

#include "firmware/request/exchange.hpp"

namespace ex9000::modbus {

/// Judges the frame of `exchange` and writes its reply, including the CRC. The reply must be sent after the
/// outcome has been carried out; it is empty for a broadcast. Changes nothing but `exchange`.
void answer(Exchange& exchange);

/// Replaces the reply with an exception. Call this if the settings could not be stored. The empty reply to a
/// broadcast stays empty.
void refuse_store(Exchange& exchange);

}  // namespace ex9000::modbus
