#include "sim/front_ends/control_socket/control.hpp"

#include <stdexcept>

#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

std::string where(const SimulatedModule& module) {
  if (!module.powered()) {
    return " without power";
  }
  return module.module().listening() ? " at " + hex_byte_text(module.module().state().in_force.address)
                                     : " starting";
}

std::string list(const LinesInUse& lines) {
  Words modules;
  for (const LineInUse& each : lines) {
    for (std::size_t i = 0; i < each.line.size(); ++i) {
      const SimulatedModule& module = each.line.module(i);
      modules.push_back(std::to_string(modules.size() + 1) + " " + std::string(module.model().designation) +
                        where(module) + (each.name.empty() ? "" : " on " + each.name));
    }
  }
  return std::to_string(modules.size()) + (modules.size() == 1 ? " module: " : " modules: ") +
         joined(modules, ", ");
}

}  // namespace

Control::Reply Control::carry_out(const std::string& command) {
  const Words words = words_of(command);
  const std::string first = words.empty() ? "" : words[0];
  try {
    if (command.find('\0') != std::string::npos) {
      fail("the command contains NUL; remove the NUL");
    }
    if (first == "advance") {
      fail("'advance' requires --speed step; without it, the lines' time advances by itself");
    }
    const bool of_program = first == "quit" || first == "list" || first == "help";
    if (of_program && words.size() != 1) {
      fail("'" + first + "': expected no arguments");
    }
    const std::string result = first == "quit"   ? ""
                               : first == "list" ? list(lines_)
                               : first == "help" ? action_shapes()
                                                 : act(lines_, words);
    return {"ok" + (result.empty() ? "" : " " + result), first == "quit"};
  } catch (const std::invalid_argument& error) {
    return {std::string("error: ") + error.what(), false};
  }
}

}  // namespace ex9000::sim
