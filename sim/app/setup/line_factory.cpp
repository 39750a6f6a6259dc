#include "sim/app/setup/line_factory.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

std::unique_ptr<Line> make_line(const LineSetup& setup, Master::Receive receive) {
  const LineKind kind = setup.instant ? kInstant : setup.strict_gaps ? kStrictlyPaced : kPaced;
  return std::make_unique<Line>(setup.modules, kind, std::move(receive));
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
  const auto add = [&](Fault fault) {
    if (fault.schedule.when == Schedule::When::At) {
      fault.schedule.time = std::max(fault.schedule.time, now);
    }
    line.faults().add(fault);
  };
  for (std::size_t i = 0; i < setup.modules.size(); ++i) {
    for (Fault fault : setup.modules[i].faults) {
      fault.module = i;
      add(fault);
    }
  }
  std::for_each(setup.faults.begin(), setup.faults.end(), add);
}

}  // namespace ex9000::sim
