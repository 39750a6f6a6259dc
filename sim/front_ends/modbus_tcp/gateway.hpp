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

/// The exceptions of a gateway (MODBUS Application Protocol V1.1b3, section 7).
enum class GatewayException : std::uint8_t {
  PathUnavailable = 0x0A,  ///< no module can have this address, or the modules that listen speak only ASCII
  NoReply = 0x0B,          ///< the request was not sent, or has no valid reply in time
};

/// Sends requests on the line as RTU frames. The unit of a request is the address in the frame.
class Gateway {
 public:
  /// Receives the PDU of the reply or of an exception; nullopt if the request is a broadcast.
  using Answer = std::function<void(std::optional<std::vector<std::uint8_t>> pdu)>;

  /// `line` must outlive this object.
  explicit Gateway(Line& line) : line_(line) {}

  /// Calls `answer` exactly once, during this call or later, unless `owner` is destroyed before the request
  /// is sent on the line. The answer is:
  /// - for unit 0: nullopt, because a broadcast has no reply;
  /// - for a unit above 247, or if at least one module listens and all that listen speak ASCII: exception
  ///   0x0A;
  /// - if the request is not sent, another master sends between the request and the end of the reply, or no
  ///   valid reply begins within RequestQueue::kReplyTimeout: exception 0x0B;
  /// - otherwise: the reply of the module.
  void ask(const MbapFrame& request, const std::weak_ptr<void>& owner, const Answer& answer);

 private:
  [[nodiscard]] bool speaks_only_ascii() const;

  Line& line_;
};

}  // namespace ex9000::sim
