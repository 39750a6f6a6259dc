// Reasons why no module replies.
#pragma once

#include <string>

#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// In one line for the log: the bytes look like Modbus TCP, no module speaks the protocol or has the address,
/// a read at address 0, or a reserved address. Empty: a module may reply, the frame is damaged, or a module
/// has no power or is starting, because its address is not known then.
std::string hint_for(const Frame& frame, const Line& line);

}  // namespace ex9000::sim
