// The JSON messages between the program and the page in sim/front_ends/panel/page.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/front_ends/panel/recent_traffic.hpp"
#include "sim/line_monitor/module_view/face.hpp"
#include "sim/virtual_line/faults/faults.hpp"

namespace ex9000::sim {

using Message = nlohmann::ordered_json;

/// Returns the constant data that the page requires to draw a module's plate.
Message plate_layout(const Model& model);

// Each part of a module's Face is a separate Message, because the parts change independently.
Message message_of(const Plate& plate);
/// Returns a message that contains the latches and the first `inputs` counters.
Message message_of(const InputRecords& records, unsigned inputs);
Message message_of(const HostWatchdogState& host_watchdog);
Message message_of(const Stored& stored);

/// Returns the list of a line's faults. `first` is the position of the line's first module across all lines,
/// from 0.
Message message_of(const std::vector<Faults::Info>& faults, std::size_t first);

/// Returns the message for the traffic entry `entry`, whose number is `number`. `modules` is the number of
/// modules on the line. A frame from a station whose number is above `modules` comes from a fault.
Message message_of(const RecentTraffic::Entry& entry, std::uint64_t number, std::size_t modules);

/// A request of the page to carry out a command.
struct PageRequest {
  std::uint64_t id = 0;  ///< chosen by the page, for the reply
  std::string command;   ///< a command of the control socket
  std::string undo;      ///< a command that undoes `command`, see PanelViewer::ask; empty: none
};

/// Returns the request in `message`, or nullopt if `message` is not a valid request to carry out a command.
std::optional<PageRequest> parse_page_request(const Message& message);

}  // namespace ex9000::sim
