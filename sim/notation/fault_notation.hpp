// A fault in the notation of the user: the kind of fault, then a value and a schedule, if the fault has them.
//
//   bit-errors 1e-4                     probability for each bit on the line
//   lost-reply every 10th reply
//   late-reply 50ms with probability 0.01
//   gone at 12.5s for 2s
//   power-cut after 3 writes
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_line/faults/fault.hpp"

namespace ex9000::sim {

/// Of the line and all its modules, or of the module at the position `module`.
Fault parse_fault(const std::string& text, std::optional<std::size_t> module = std::nullopt);

/// A typical fault of each kind.
std::vector<std::string> usual_faults();

std::string fault_help();

}  // namespace ex9000::sim
