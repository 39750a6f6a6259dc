// Reasons why no module replies.
#pragma once

#include <string>

#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Returns why no module of `line` replies to `frame` of the master, in one line for the log: the bytes look
/// like Modbus TCP, no module speaks the protocol of the frame or has its address, a read at address 0, or a
/// reserved address. Returns an empty string if a module may reply, if the frame is damaged, or if a module
/// has no power or is starting, because its address is not known then.
std::string hint_for(const Frame& frame, const Line& line);

}  // namespace ex9000::sim
