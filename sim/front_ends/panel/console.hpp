// Requests that a person sends to a line from the panel's page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "sim/front_ends/panel/messages.hpp"
#include "sim/virtual_line/line/request_queue.hpp"

namespace ex9000::sim {

/// A request of the page for a line: a PDU for a Modbus address, or a DCON command.
struct ConsoleRequest {
  std::uint64_t id = 0;      ///< chosen by the page, for the reply
  std::size_t line = 0;      ///< position of the line, from 0
  std::uint8_t address = 0;  ///< address of the module; 0: all modules. A DCON command does not use it
  std::string text;          ///< a DCON command if it begins with a delimiter, otherwise a PDU in hex
};

/// Returns the request in `message`, or nullopt if `message` does not have the form of a request of the
/// console or if its address is above 247.
std::optional<ConsoleRequest> parse_console_request(const Message& message);

/// Returns the frame to send. `is_reply`, `done` and `owner` are not set. Throws std::invalid_argument with a
/// message for the user if the text is too long, or is neither a DCON command nor a PDU.
RequestQueue::Request frame_of(const ConsoleRequest& request);

/// Returns the message for the page: the reply, its meaning and its delay, or the reason why there is no
/// reply.
Message answer_to(const ConsoleRequest& request, const RequestQueue::Reply& reply);
/// Returns the message for a request that was not sent or that has no reply. `why` is the reason.
Message rejection_of(const ConsoleRequest& request, const std::string& why);

}  // namespace ex9000::sim
