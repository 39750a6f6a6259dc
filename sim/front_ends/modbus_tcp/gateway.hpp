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

/// The PDU of the reply or of an exception; nullopt after a broadcast.
using GatewayAnswer = std::function<void(const std::optional<std::vector<std::uint8_t>>& pdu)>;

/// In this time, a module that stores settings begins its reply (wire.md section 7). libmodbus waits 500 ms
/// for its answer, so exception 0x0B arrives in time.
constexpr VirtualTime kGatewayTimeout = std::chrono::milliseconds(200);

/// Sends a request as an RTU frame to its unit. Calls `answer` exactly once, now or later, unless `owner`
/// dies before the request is sent, or `line` before the answer:
/// - for unit 0: nullopt, because a broadcast has no reply;
/// - for a unit above 247, or if at least one module listens and all that listen speak ASCII: exception 0x0A;
/// - if the request is not sent, another master sends before the end of the reply, or no valid reply begins
///   in time: exception 0x0B;
/// - otherwise: the reply of the module.
/// In time: within `timeout`, the longest response delay of the modules, and the time that the line needs for
/// the silence after the request and for the reply.
void ask_on_line(Line& line, const MbapFrame& request, const std::weak_ptr<void>& owner,
                 const GatewayAnswer& answer, VirtualTime timeout = kGatewayTimeout);

}  // namespace ex9000::sim
