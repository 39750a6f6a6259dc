// Requests that a person sends to a line from the panel's page.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "sim/front_ends/panel/messages.hpp"
#include "sim/virtual_line/line/request_queue.hpp"

namespace ex9000::sim {

/// A PDU for a Modbus address, or a DCON command.
struct ConsoleRequest {
  std::uint64_t id = 0;      ///< chosen by the page, for the reply
  std::size_t line = 0;      ///< position of the line, from 0
  std::uint8_t address = 0;  ///< address of the module; 0: all modules. A DCON command does not use it
  std::string text;          ///< a DCON command if it begins with a delimiter, otherwise a PDU in hex
};

/// nullopt: not of this form, or an address above 247.
std::optional<ConsoleRequest> parse_console_request(const Message& message);

/// Without `is_reply`, `done` and `owner`. Throws if the text is too long, or no DCON command and no PDU.
RequestQueue::Request frame_of(const ConsoleRequest& request);

/// For the page: the reply with its meaning and delay, or why there is none.
Message answer_to(const ConsoleRequest& request, const RequestQueue::Reply& reply);
/// For a request that was not sent or has no reply.
Message rejection_of(const ConsoleRequest& request, const std::string& why);

}  // namespace ex9000::sim
