// Creates a line from its description.
#pragma once

#include <memory>

#include "sim/app/setup/setup.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Its modules have no power yet; its master has the factory baud rate and 8N1.
std::unique_ptr<Line> make_line(const LineSetup& setup, Master::Receive receive);

/// What `setup` gives, else that of the first module. After `line` has started up.
SerialMode first_mode(const LineSetup& setup, const Line& line);

/// After the start and `Line::configure_faults`. A fault whose time has passed takes effect immediately.
void begin_programs(Line& line, const LineSetup& setup);

}  // namespace ex9000::sim
