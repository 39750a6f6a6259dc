// Errors of a frame, as text for people.
#pragma once

#include <string>

#include "sim/line_monitor/frames/frame_watch.hpp"

namespace ex9000::sim {

/// Describes a collision, a rate or parity of the sender that differs from that of the line, and the bytes in
/// `frame.changes`. Positions of bytes count from 1. Returns an empty string if there is no error.
std::string line_error(const Frame& frame);

/// Describes the errors of `line_error` and, if there was no collision, the error of `check_error`. Returns
/// an empty string if there is no error.
std::string errors(const Frame& frame);

}  // namespace ex9000::sim
