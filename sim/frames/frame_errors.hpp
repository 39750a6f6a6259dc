// Errors of a frame, as text for people.
#pragma once

#include <string>

#include "sim/frames/frame_watch.hpp"

namespace ex9000::sim {

/// Describes a collision, a rate that is not the line's, and bytes that a disturbance has changed; positions
/// count from 1. Empty: no error.
std::string line_error(const Frame& frame);

/// Describes the errors of `line_error` and, if there was no collision, the error of `check_error`. Empty: no
/// error.
std::string errors(const Frame& frame);

}  // namespace ex9000::sim
