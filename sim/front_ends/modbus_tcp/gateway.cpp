#include "sim/front_ends/modbus_tcp/gateway.hpp"

#include "sim/virtual_line/line/rtu_frame.hpp"

namespace ex9000::sim {

namespace {

// The exceptions of a gateway (MODBUS Application Protocol V1.1b3, section 7).
constexpr std::uint8_t kPathUnavailable = 0x0A;
constexpr std::uint8_t kNoReply = 0x0B;

std::vector<std::uint8_t> exception_pdu(const MbapFrame& request, std::uint8_t code) {
  return {static_cast<std::uint8_t>(request.pdu[0] | kRtuException), code};
}

/// At least one module listens, and all that listen speak ASCII.
bool speaks_only_ascii(const Line& line) {
  bool ascii = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const SimulatedModule& module = line.module(i);
    if (module.powered() && module.module().listening()) {
      if (module.module().state().in_force.protocol == Protocol::ModbusRtu) {
        return false;
      }
      ascii = true;
    }
  }
  return ascii;
}

}  // namespace

void ask_on_line(Line& line, const MbapFrame& request, const std::weak_ptr<void>& owner,
                 const GatewayAnswer& answer, VirtualTime timeout) {
  const bool broadcast = request.unit == kRtuBroadcast;
  if (request.unit > kLastRtuAddress || speaks_only_ascii(line)) {
    answer(broadcast ? std::nullopt : std::optional(exception_pdu(request, kPathUnavailable)));
    return;
  }
  RequestQueue::Request asked;
  asked.bytes = rtu_frame(request.unit, request.pdu);
  asked.expects_reply = !broadcast;
  asked.timeout = timeout + line.longest_response_delay() + line.rtu_silence() +
                  line.master().takes(rtu_reply_size({asked.bytes.data(), asked.bytes.size()}));
  asked.owner = owner;
  asked.is_reply = [sent = asked.bytes](Bytes frame) {
    return is_rtu_reply({sent.data(), sent.size()}, frame);
  };
  asked.done = [broadcast, answer,
                no_reply = exception_pdu(request, kNoReply)](const RequestQueue::Reply& reply) {
    if (broadcast) {
      answer(std::nullopt);
    } else if (reply.bytes.empty()) {
      answer(no_reply);
    } else {
      const Bytes pdu = pdu_of({reply.bytes.data(), reply.bytes.size()});
      answer(std::vector<std::uint8_t>(pdu.begin(), pdu.end()));
    }
  };
  line.requests().ask(std::move(asked));
}

}  // namespace ex9000::sim
