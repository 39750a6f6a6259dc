// Creates a line from its description.
#pragma once

#include <memory>

#include "sim/app/setup/setup.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Creates a line. Its modules have no power yet, and its master uses the factory baud rate and 8N1.
std::unique_ptr<Line> make_line(const LineSetup& setup, Master::Receive receive);

/// Returns the rate and the format that `line` has at first: those that `setup` gives, and otherwise those of
/// the first module. Call this after `line` has started up.
SerialMode first_mode(const LineSetup& setup, const Line& line);

/// Starts the input programs and adds the faults. Call this after the line has started up and after
/// `Line::configure_faults`. A fault whose time has already passed takes effect immediately.
void begin_programs(Line& line, const LineSetup& setup);

}  // namespace ex9000::sim
