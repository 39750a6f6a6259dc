// Passes requests of Modbus TCP to the modules of a line.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "sim/front_ends/modbus_tcp/mbap.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Receives the PDU of the reply or of an exception; nullopt if the request is a broadcast.
using GatewayAnswer = std::function<void(const std::optional<std::vector<std::uint8_t>>& pdu)>;

/// The usual timeout of the gateway: the time within which a module that stores settings begins its reply
/// (wire.md section 7). libmodbus waits 500 ms for its answer, so exception 0x0B arrives in time.
constexpr VirtualTime kGatewayTimeout = std::chrono::milliseconds(200);

/// Sends a request on `line` as an RTU frame. The unit of the request is the address in the frame. Calls
/// `answer` exactly once, during this call or later, unless `owner` is destroyed before the request is sent
/// on the line, or `line` is destroyed first. The answer is:
/// - for unit 0: nullopt, because a broadcast has no reply;
/// - for a unit above 247, or if at least one module listens and all that listen speak ASCII: exception 0x0A;
/// - if the request is not sent, if another master sends between the request and the end of the reply, or if
///   no valid reply begins in time: exception 0x0B;
/// - otherwise: the reply of the module.
///
/// A reply begins in time within `timeout`, the longest response delay of the modules, and the time that the
/// line needs for the silence after the request and for the reply.
void ask_on_line(Line& line, const MbapFrame& request, const std::weak_ptr<void>& owner,
                 const GatewayAnswer& answer, VirtualTime timeout = kGatewayTimeout);

}  // namespace ex9000::sim
