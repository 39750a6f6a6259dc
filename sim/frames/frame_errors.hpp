// Errors of a frame, as text for people.
#pragma once

#include <string>

#include "sim/frames/frame_watch.hpp"

namespace ex9000::sim {

/// Describes collisions and bytes that a disturbance has changed; positions count from 1. Empty: no error.
std::string line_error(const Frame& frame);

/// Describes the errors of `line_error` and those that receivers detect: a wrong CRC or checksum. Empty: no
/// error.
std::string errors(const Frame& frame);

}  // namespace ex9000::sim
