#include "sim/front_ends/modbus_tcp/gateway.hpp"

#include "sim/virtual_line/line/rtu_frame.hpp"

namespace ex9000::sim {

namespace {

std::vector<std::uint8_t> exception_pdu(const MbapFrame& request, GatewayException code) {
  return {static_cast<std::uint8_t>(request.pdu[0] | kRtuException), static_cast<std::uint8_t>(code)};
}

}  // namespace

void Gateway::ask(const MbapFrame& request, const std::weak_ptr<void>& owner, const Answer& answer) {
  const bool broadcast = request.unit == kRtuBroadcast;
  if (request.unit > kLastRtuAddress || speaks_only_ascii()) {
    answer(broadcast ? std::nullopt
                     : std::optional(exception_pdu(request, GatewayException::PathUnavailable)));
    return;
  }
  RequestQueue::Request asked;
  asked.bytes = rtu_frame(request.unit, request.pdu);
  asked.expects_reply = !broadcast;
  asked.owner = owner;
  asked.is_reply = [sent = asked.bytes](Bytes frame) {
    return is_rtu_reply({sent.data(), sent.size()}, frame);
  };
  asked.done = [broadcast, answer, no_reply = exception_pdu(request, GatewayException::NoReply)](
                   const RequestQueue::Reply& reply) {
    if (broadcast) {
      answer(std::nullopt);
    } else if (reply.bytes.empty()) {
      answer(no_reply);
    } else {
      const Bytes pdu = pdu_of({reply.bytes.data(), reply.bytes.size()});
      answer(std::vector<std::uint8_t>(pdu.begin(), pdu.end()));
    }
  };
  line_.requests().ask(std::move(asked));
}

/// Returns whether at least one module listens, and all modules that listen speak ASCII.
bool Gateway::speaks_only_ascii() const {
  bool ascii = false;
  for (std::size_t i = 0; i < line_.size(); ++i) {
    const SimulatedModule& module = line_.module(i);
    if (module.powered() && module.module().listening()) {
      if (module.module().state().in_force.protocol == Protocol::ModbusRtu) {
        return false;
      }
      ascii = true;
    }
  }
  return ascii;
}

}  // namespace ex9000::sim
