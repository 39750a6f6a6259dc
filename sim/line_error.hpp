// What went wrong with a frame on its way, for people.
#pragma once

#include <string>

#include "sim/frame_watch.hpp"

namespace ex9000::sim {

/// Drivers that were on at once, and bytes that a disturbance has changed; positions count from 1. Empty:
/// none of it.
std::string line_error(const Frame& frame);

/// That, and what receivers notice of it: a CRC or checksum that is wrong. Empty: nothing is wrong, as far as
/// one can tell.
std::string errors(const Frame& frame);

}  // namespace ex9000::sim
