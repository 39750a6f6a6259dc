#include "sim/app/run_setup/line_factory.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

namespace {

LineKind kind_of(const LineSetup& setup) {
  if (setup.instant) {
    return kInstant;
  }
  return setup.strict_gaps ? kStrictlyPaced : kPaced;
}

}  // namespace

std::unique_ptr<Line> make_line(const LineSetup& setup, Master::Receive receive) {
  return std::make_unique<Line>(setup.modules, kind_of(setup), std::move(receive));
}

SerialMode first_mode(const LineSetup& setup, const Line& line) {
  const SerialMode first = line.module(0).mode();
  return {setup.baud.value_or(first.baud), setup.format.value_or(first.format)};
}

void begin_programs(Line& line, const LineSetup& setup) {
  for (std::size_t i = 0; i < setup.modules.size(); ++i) {
    for (const InputProgram& program : setup.modules[i].inputs) {
      line.move_input(i, program);
    }
  }
  const VirtualTime now = line.clock().virtual_now();
  for (Fault fault : setup.faults) {
    // A fault whose time has passed while the modules started up takes effect now.
    if (fault.schedule.when == Schedule::When::At) {
      fault.schedule.time = std::max(fault.schedule.time, now);
    }
    line.faults().add(fault);
  }
}

}  // namespace ex9000::sim
