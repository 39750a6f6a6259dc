// The JSON messages between the program and the page in sim/front_ends/panel/page.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim/front_ends/panel/recent_traffic.hpp"
#include "sim/virtual_line/faults/faults.hpp"

namespace ex9000::sim {

using Message = nlohmann::ordered_json;

inline std::int64_t microseconds(VirtualTime time) {
  return std::chrono::duration_cast<std::chrono::microseconds>(time).count();
}

/// `first`: the position of the line's first module across all lines, from 0.
Message message_of(const std::vector<Faults::Info>& faults, std::size_t first);

/// `modules`: on the line. A frame from a station above comes from a fault.
Message message_of(const RecentTraffic::Entry& entry, std::uint64_t number, std::size_t modules);

struct PageRequest {
  std::uint64_t id = 0;  ///< chosen by the page, for the reply
  std::string command;   ///< a command of the control socket
  std::string undo;      ///< a command that undoes `command`, see PanelViewer::ask; empty: none
};

/// nullopt: not a valid request to carry out a command.
std::optional<PageRequest> parse_page_request(const Message& message);

}  // namespace ex9000::sim
