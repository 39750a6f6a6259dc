// From what is written of a line to the line.
#pragma once

#include <memory>

#include "sim/line.hpp"
#include "sim/setup.hpp"

namespace ex9000::sim {

/// Without power; its master is at the factory's rate.
std::unique_ptr<Line> make_line(const LineSetup& setup, Master::Receive receive);

/// Once it has come up: inputs move by themselves, and faults strike. Throws std::invalid_argument, one line,
/// where a fault is of a module that the line lacks, or comes too late.
void begin_programs(Line& line, const LineSetup& setup);

}  // namespace ex9000::sim
