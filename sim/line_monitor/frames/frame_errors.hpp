// Errors of a frame, as text for people.
#pragma once

#include <string>

#include "sim/line_monitor/frames/frame_watch.hpp"

namespace ex9000::sim {

/// A collision, a rate or parity unlike the line's, and `frame.changes`; bytes count from 1. Empty: no error.
std::string line_error(const Frame& frame);

/// Also the `check_error`, unless there was a collision.
std::string errors(const Frame& frame);

}  // namespace ex9000::sim
