#include "sim/notation/actions.hpp"

#include <algorithm>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <string_view>

#include "sim/notation/fault_notation.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/notation/shape.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/help_row.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

struct Call {
  const LineInUse& in_use;
  std::size_t index;         ///< of the module on the line, from 0
  std::size_t first_module;  ///< the position of the line's first module across all lines, from 0
  Words args;
  std::string result = {};  ///< of an action that reads, or adds a fault

  [[nodiscard]] Line& line() const { return in_use.line; }
  [[nodiscard]] SimulatedModule& module() const { return in_use.line.module(index); }
  [[nodiscard]] SimulatedModule& powered_module() const {
    if (!module().powered()) {
      throw NotNow("the module has no power; use 'power on', or end the fault that switches the supply off");
    }
    return module();
  }
  [[nodiscard]] Master& own_master() const {
    if (in_use.has_serial_port) {
      fail("the line's serial port keeps its rate and format; start the program with others");
    }
    return in_use.line.master();
  }
  [[nodiscard]] unsigned input() const { return parse_input(args[0], module().model()); }
  void add(unsigned number) { result += (result.empty() ? "" : " ") + std::to_string(number); }
};

std::string host_watchdog(const Settings& settings) {
  return settings.timeout_status ? "expired" : settings.watchdog_enabled ? "enabled" : "disabled";
}

std::string status(const SimulatedModule& module) {
  std::string text(module.model().designation);
  if (!module.powered()) {
    return text + " power=off";
  }
  if (!module.module().listening()) {
    return text + " power=on mode=starting";
  }
  const State& state = module.module().state();
  const InForce& in_force = state.in_force;
  std::ostringstream rest;
  rest << " power=on address=" << hex_byte_text(in_force.address)
       << " serial=" << hex_long_text(state.serial_number())
       << " protocol=" << (in_force.protocol == Protocol::Ascii ? "ascii" : "modbus")
       << " baud=" << baud_rate(in_force.baud_code)
       << " format=" << line_format_text(line_format(in_force.baud_code))
       << " checksum=" << (in_force.checksum ? "on" : "off")
       << " mode=" << (in_force.init_mode ? "init" : "normal")
       << " host-watchdog=" << host_watchdog(state.settings) << " timeout=" << std::fixed
       << std::setprecision(1) << state.settings.watchdog_timeout / 10.0
       << "s fed-by=" << (state.settings.fed_by_requests ? "requests" : "host-ok")
       << " response-delay=" << static_cast<unsigned>(state.settings.response_delay)
       << "ms inverted=" << hex_word_text(state.settings.inverted_inputs)
       << " watchdog-resets=" << module.watchdog_resets();
  return text + rest.str();
}

std::string led(const SimulatedModule& module) {
  if (!module.powered()) {
    return "off";
  }
  return module.module().led_pattern() == StatusLed::Pattern::Steady ? "on" : "flashing";
}

void end_fault(Line& line, const std::string& which) {
  constexpr std::uint64_t kMostFaults = 999'999'999;
  const auto fault = whole_number(which, kMostFaults);
  if (which == "all") {
    line.faults().remove_all();
  } else if (!fault) {
    fail("expected fault off K|all");
  } else if (!line.faults().remove(*fault)) {
    throw NotNow("no fault " + which + " on this line");
  }
}

std::string list_faults(const Call& call) {
  const std::vector<Faults::Info> faults = call.line().faults().list();
  std::string text = std::to_string(faults.size()) + (faults.size() == 1 ? " fault:" : " faults:");
  for (const Faults::Info& fault : faults) {
    text += (&fault == faults.data() ? " " : "; ") + std::to_string(fault.number) +
            (fault.in_progress != 0 ? "*" : "") + " x" + std::to_string(fault.occurrences_so_far) + " " +
            (fault.module ? std::to_string(call.first_module + *fault.module + 1) + " " : "") + fault.text;
  }
  return text;
}

struct Action {
  enum class Of { Module, Line, Program } of;
  std::string_view shape;
  bool changes;  ///< false: only reads
  std::string_view does;
  void (*act)(Call& call);  ///< null: carried out elsewhere

  [[nodiscard]] std::string text() const { return (of == Of::Module ? "N " : "") + std::string(shape); }
};
using Of = Action::Of;

constexpr Action kActions[] = {
    {Of::Module, "power on|off", true, "switches the supply",
     [](Call& call) { call.module().power(parse_on_off(call.args[0])); }},
    {Of::Module, "reset", true, "resets the module; the supply stays on",
     [](Call& call) { call.powered_module().reset(); }},
    {Of::Module, "init on|off", true, "ties INIT* to GND, or releases it",
     [](Call& call) { call.module().set_init(parse_on_off(call.args[0])); }},
    {Of::Module, "input C on|off", true, "sets the level of input C, from 0",
     [](Call& call) { call.module().set_input(call.input(), parse_on_off(call.args[1])); }},
    {Of::Module, "pulse C [xCOUNT]", true, "applies COUNT full pulses to input C at once (default 1)",
     [](Call& call) { call.module().pulse_input(call.input(), parse_pulses(call.args).count); }},
    {Of::Module, "fault FAULT...", true,
     "adds a fault of the module, see 'help faults'; replies with its number",
     [](Call& call) {
       call.result = std::to_string(call.line().faults().add(parse_fault(joined(call.args), call.index)));
     }},
    {Of::Module, "hang", true, "stops the main loop until the module watchdog resets the module",
     [](Call& call) { call.powered_module().hang(); }},
    {Of::Module, "inputs", false, "reads the input levels in hex; bit n is input n",
     [](Call& call) { call.result = hex_word_text(call.module().input_levels()); }},
    {Of::Module, "outputs", false, "reads the outputs in hex; bit n is output n",
     [](Call& call) { call.result = hex_word_text(call.module().outputs()); }},
    {Of::Module, "timers", false,
     "reads the remaining time of each output's timer in 0.1 s; 0: it does not run",
     [](Call& call) {
       const auto& timers = call.powered_module().module().state().output_timers;
       for (unsigned output = 0; output < call.module().model().outputs; ++output) {
         call.add(timers.left(output));
       }
     }},
    {Of::Module, "filters", false, "reads the filter of each input in ms",
     [](Call& call) {
       const auto& filters = call.powered_module().module().state().settings.input_filters;
       for (unsigned input = 0; input < call.module().model().inputs; ++input) {
         call.add(filters.of(input));
       }
     }},
    {Of::Module, "led", false, "reads the status LED: on, off or flashing",
     [](Call& call) { call.result = led(call.module()); }},
    {Of::Module, "status", false, "reads the model, the settings in force, the mode and the watchdogs",
     [](Call& call) { call.result = status(call.module()); }},
    {Of::Line, "baud RATE", true, "sets the line's baud rate until a pseudo-terminal sets it",
     [](Call& call) { call.own_master().set_baud(parse_baud_rate(call.args[0])); }},
    {Of::Line, "format FORMAT", true, "sets the line's format: 8N1, 8N2, 8E1 or 8O1",
     [](Call& call) { call.own_master().set_format(parse_line_format(call.args[0])); }},
    {Of::Line, "fault FAULT...", true,
     "adds a fault of the line or of all its modules; replies with its number",
     [](Call& call) {
       if (call.args[0] == "off") {
         end_fault(call.line(), call.args.size() == 2 ? call.args[1] : "");
       } else {
         call.result = std::to_string(call.line().faults().add(parse_fault(joined(call.args))));
       }
     }},
    {Of::Line, "fault off K|all", true, "removes the fault with this number, or all faults", nullptr},
    {Of::Line, "faults", false,
     "lists the faults: number, * if in progress, x and number of occurrences, module, text",
     [](Call& call) { call.result = list_faults(call); }},
    {Of::Line, "sent", false, "reads how many bytes the line has written to each of its ports",
     [](Call& call) { call.result = std::to_string(call.in_use.sent ? call.in_use.sent() : 0); }},
    {Of::Program, "line NAME ...", true,
     "one of the six above, for that line; required if there are several lines", nullptr},
    {Of::Program, "advance TIME [after N] [quiet]", true,
     "requires --speed step. With 'after N', first waits until N bytes have arrived at the ports.\n"
     "Sends all arrived bytes on the lines, and advances the time by TIME. With 'quiet', stops as\n"
     "soon as nothing is pending. Replies with the time",
     nullptr},
    {Of::Program, "list", false, "lists the modules", nullptr},
    {Of::Program, "help", false, "lists the commands", nullptr},
    {Of::Program, "quit", true, "ends the simulator", nullptr},
};

const Action* action_called(const std::string& name, Of of) {
  const auto* const found = std::find_if(std::begin(kActions), std::end(kActions), [&](const Action& action) {
    return action.of == of && action.act != nullptr && is_shape_of(action.shape, name);
  });
  return found == std::end(kActions) ? nullptr : found;
}

[[noreturn]] void refuse(const std::string& text) {
  fail("'" + text + "' is not a command; expected one of " + action_shapes());
}

/// `call.args` begin with the action's name. `said`: for the log.
std::string carry_out(Call call, Of of, const std::string& said) {
  const Action* const action = action_called(call.args[0], of);
  if (action == nullptr) {
    refuse(joined(call.args));
  }
  call.args.erase(call.args.begin());
  check_shape(action->shape, call.args, of == Of::Module ? "expected N " : "expected ");
  action->act(call);
  if (action->changes && call.in_use.note) {
    call.in_use.note(said);
  }
  return call.result;
}

std::string on_module(const LinesInUse& lines, const Words& words) {
  std::size_t modules = 0;
  for (const LineInUse& each : lines) {
    modules += each.line.size();
  }
  const auto position = whole_number(words[0], modules);
  if (!position || *position == 0) {
    fail("no module " + words[0] + "; expected a position from 1 to " + std::to_string(modules));
  }
  if (words.size() == 1) {
    refuse(words[0]);
  }
  std::size_t index = *position - 1;
  auto each = lines.begin();
  for (; index >= each->line.size(); ++each) {
    index -= each->line.size();
  }
  return carry_out({*each, index, 0, Words(words.begin() + 1, words.end())}, Of::Module, joined(words));
}

std::string on_named_line(const LinesInUse& lines, const Words& words) {
  if (words.size() < 3) {
    fail("expected line NAME and a command of a line, for example line NAME faults");
  }
  std::size_t first_module = 0;
  for (const LineInUse& each : lines) {
    if (each.name == words[1]) {
      const Words action(words.begin() + 2, words.end());
      return carry_out({each, 0, first_module, action}, Of::Line, joined(action));
    }
    first_module += each.line.size();
  }
  const std::string names = names_of(lines);
  fail("no line '" + words[1] + "'; " +
       (names.empty() ? "the only line has no name; leave out 'line NAME'" : "expected one of " + names));
}

}  // namespace

std::string act(const LinesInUse& lines, const Words& words) {
  const std::string first = words.empty() ? "" : words[0];
  if (!first.empty() && first.find_first_not_of("0123456789") == std::string::npos) {
    return on_module(lines, words);
  }
  if (first == "line") {
    return on_named_line(lines, words);
  }
  if (action_called(first, Of::Line) == nullptr) {
    refuse(first);
  }
  if (lines.size() != 1) {
    fail("there are several lines; put 'line NAME' before the command");
  }
  return carry_out({lines[0], 0, 0, words}, Of::Line, joined(words));
}

bool only_reads(const std::string& name) {
  return std::any_of(std::begin(kActions), std::end(kActions), [&](const Action& action) {
    return !action.changes && is_shape_of(action.shape, name);
  });
}

Pulses parse_pulses(const Words& args) {
  constexpr std::uint64_t kMostChannels = 16;
  constexpr std::uint64_t kMostPulses = 1'000'000;
  Pulses pulses{static_cast<unsigned>(parse_whole_number(args[0], 0, kMostChannels - 1)), 1};
  if (args.size() == 2) {
    if (args[1][0] != 'x') {
      fail("'" + args[1] + "': expected a count with an x before it, for example x5");
    }
    pulses.count = static_cast<std::uint32_t>(parse_whole_number(args[1].substr(1), 1, kMostPulses));
  }
  return pulses;
}

std::string action_shapes() {
  Words shapes;
  for (const Action& action : kActions) {
    shapes.push_back(action.text());
  }
  return joined(shapes, ", ");
}

std::string action_help() {
  constexpr std::size_t kColumn = 20;
  std::string text;
  for (const Action& action : kActions) {
    text += help_row(action.text(), action.does, kColumn);
  }
  return text;
}

}  // namespace ex9000::sim
