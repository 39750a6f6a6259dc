// The state of a module's channels; bit n is channel n. Nothing has a side effect.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/utility/device/device.hpp"

namespace ex9000::utility {

// Throw like Device. `model`: has such channels.
unsigned outputs_of(Device& device, const Model& model);
unsigned inputs_of(Device& device, const Model& model);
/// Of rising edges, or of falling ones.
unsigned latches_of(Device& device, const Model& model, bool high);
std::vector<std::uint32_t> counters_of(Device& device, const Model& model);

/// The host watchdog.
bool has_timed_out(Device& device);

}  // namespace ex9000::utility
