#include "sim/front_ends/control_socket/control.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

#include <array>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

namespace ex9000::sim {

namespace {

void require_power(const SimulatedModule& module) {
  if (!module.powered()) {
    fail("the module has no power; use 'power on', or end the fault that switches the supply off");
  }
}

std::string power(SimulatedModule& module, const Words& args) {
  module.power(parse_on_off(args[0]));
  return "";
}

std::string reset(SimulatedModule& module, const Words& /*args*/) {
  require_power(module);
  module.reset();
  return "";
}

std::string init(SimulatedModule& module, const Words& args) {
  module.set_init(parse_on_off(args[0]));
  return "";
}

std::string input(SimulatedModule& module, const Words& args) {
  const unsigned channel = parse_input(args[0], module.model());
  module.set_input(channel, parse_on_off(args[1]));
  return "";
}

std::string pulse(SimulatedModule& module, const Words& args) {
  const unsigned channel = parse_input(args[0], module.model());
  const std::uint64_t count = args.size() == 1 ? 1 : parse_whole_number(args[1], 1, kMostPulses);
  module.pulse_input(channel, static_cast<std::uint32_t>(count));
  return "";
}

std::string inputs(SimulatedModule& module, const Words& /*args*/) {
  return hex_word_text(module.input_levels());
}

std::string outputs(SimulatedModule& module, const Words& /*args*/) {
  return hex_word_text(module.outputs());
}

std::string led(SimulatedModule& module, const Words& /*args*/) {
  if (!module.powered()) {
    return "off";
  }
  return module.module().led_pattern() == StatusLed::Pattern::Steady ? "on" : "flashing";
}

std::string hang(SimulatedModule& module, const Words& /*args*/) {
  require_power(module);
  module.hang();
  return "";
}

std::string host_watchdog(const Settings& settings) {
  if (settings.timeout_status) {
    return "expired";
  }
  return settings.watchdog_enabled ? "enabled" : "disabled";
}

std::string status(SimulatedModule& module, const Words& /*args*/) {
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

/// Returns the results of `number_of` for all channels, separated by spaces.
template <class NumberOf>
std::string for_each_channel(unsigned channels, NumberOf number_of) {
  std::string text;
  for (unsigned channel = 0; channel < channels; ++channel) {
    text += (channel == 0 ? "" : " ") + std::to_string(number_of(channel));
  }
  return text;
}

std::string timers(SimulatedModule& module, const Words& /*args*/) {
  require_power(module);
  const OutputTimers& timers = module.module().state().output_timers;
  return for_each_channel(module.model().outputs, [&](unsigned channel) { return timers.left(channel); });
}

std::string filters(SimulatedModule& module, const Words& /*args*/) {
  require_power(module);
  const InputFilters& filters = module.module().state().settings.input_filters;
  return for_each_channel(module.model().inputs, [&](unsigned channel) { return filters.of(channel); });
}

/// A command for one module. The position of the module precedes the command.
struct Verb {
  std::string_view name;
  std::string_view args;
  std::size_t fewest;
  std::size_t most;
  std::string_view does;
  std::string (*handler)(SimulatedModule& module, const Words& args);
};

constexpr std::array<Verb, 12> kVerbs{{
    {"power", "on|off", 1, 1, "switches the supply", power},
    {"reset", "", 0, 0, "resets the module; the supply stays on", reset},
    {"init", "on|off", 1, 1, "ties INIT* to GND, or releases it", init},
    {"input", "C on|off", 2, 2, "sets the level of input C, from 0", input},
    {"pulse", "C [COUNT]", 1, 2, "applies COUNT full pulses to input C immediately (default 1)", pulse},
    {"inputs", "", 0, 0, "reads the input levels in hex; bit n is input n", inputs},
    {"outputs", "", 0, 0, "reads the outputs in hex; bit n is output n", outputs},
    {"timers", "", 0, 0,
     "reads the remaining time of each output's timer in units of 0.1 s; 0: the timer does not run", timers},
    {"filters", "", 0, 0, "reads the filter of each input in ms", filters},
    {"led", "", 0, 0, "reads the status LED: on, off or flashing", led},
    {"hang", "", 0, 0, "stops the main loop until the module watchdog resets the module", hang},
    {"status", "", 0, 0, "reads the model, the settings in force, the mode and the watchdogs", status},
}};

/// A command that is not a Verb, as the help shows it.
struct Form {
  std::string_view shape;
  std::string_view does;  ///< may have several lines
};

constexpr std::array<Form, 12> kOtherForms{{
    {"N fault FAULT", "adds a fault of module N, see below; replies with its number"},
    {"baud RATE",
     "sets the line's baud rate until bytes from a pseudo-terminal set it; rejected with a serial port"},
    {"format FORMAT", "sets the line's format: 8N1, 8N2, 8E1 or 8O1; rejected with a serial port"},
    {"sent", "reads how many bytes the line has written to each of its ports"},
    {"fault FAULT", "adds a fault of the line or of all its modules, see below; replies with its number"},
    {"fault off K|all", "removes the fault with this number, or all faults"},
    {"faults", "lists the faults: number, * if in progress, x and number of occurrences, module, text"},
    {"line NAME ...", "one of the six above, for that line; required if there are several lines"},
    {"advance TIME [after N] [quiet]",
     "\nrequires --speed step. With 'after N', first waits until N bytes have arrived at the ports."
     "\nSends all arrived bytes on the lines, and advances the time by TIME. With 'quiet', stops as"
     "\nsoon as nothing is pending. Replies with the time"},
    {"list", "lists the modules"},
    {"help", "lists the commands"},
    {"quit", "ends the simulator"},
}};

std::string shape(const Verb& verb) {
  return "N " + std::string(verb.name) + (verb.args.empty() ? "" : " ") + std::string(verb.args);
}

std::string all_shapes() {
  Words shapes;
  for (const Verb& verb : kVerbs) {
    shapes.push_back(shape(verb));
  }
  for (const Form& form : kOtherForms) {
    shapes.emplace_back(form.shape);
  }
  return joined(shapes, ", ");
}

std::string where(const SimulatedModule& module) {
  if (!module.powered()) {
    return " without power";
  }
  return module.module().listening() ? " at " + hex_byte_text(module.module().state().in_force.address)
                                     : " starting";
}

using Lines = std::vector<Control::ControlledLine>;

std::string list(const Lines& lines) {
  Words modules;
  for (const Control::ControlledLine& controlled : lines) {
    for (std::size_t i = 0; i < controlled.line.size(); ++i) {
      const SimulatedModule& module = controlled.line.module(i);
      modules.push_back(std::to_string(modules.size() + 1) + " " + std::string(module.model().designation) +
                        where(module) + (controlled.name.empty() ? "" : " on " + controlled.name));
    }
  }
  return std::to_string(modules.size()) + (modules.size() == 1 ? " module: " : " modules: ") +
         joined(modules, ", ");
}

const Verb& verb_called(const std::string& name) {
  for (const Verb& verb : kVerbs) {
    if (verb.name == name) {
      return verb;
    }
  }
  fail("'" + name + "' is not a command; expected one of " + all_shapes());
}

std::string add_fault(Line& line, std::optional<std::size_t> module, const std::string& text) {
  return std::to_string(line.faults().add(parse_fault(text, module)));
}

std::string end_fault(Line& line, const Words& words) {
  constexpr std::uint64_t kMostFaults = 999'999'999;
  const std::string which = words.size() == 3 ? words[2] : "";
  const auto fault = whole_number(which, kMostFaults);
  if (which == "all") {
    line.faults().remove_all();
  } else if (!fault) {
    fail("expected fault off K|all");
  } else if (!line.faults().remove(*fault)) {
    fail("no fault " + which + " on this line; 'faults' lists the faults");
  }
  return "";
}

/// Returns the faults of the line as text. `position` is the position of the line's first module across all
/// lines, from 0.
std::string list_faults(Line& line, std::size_t position) {
  const std::vector<Faults::Info> faults = line.faults().list();
  std::string text = std::to_string(faults.size()) + (faults.size() == 1 ? " fault:" : " faults:");
  for (const Faults::Info& fault : faults) {
    text += (&fault == faults.data() ? " " : "; ") + std::to_string(fault.number) +
            (fault.in_progress != 0 ? "*" : "") + " x" + std::to_string(fault.occurrences_so_far) + " " +
            (fault.module ? std::to_string(position + *fault.module + 1) + " " : "") + fault.text;
  }
  return text;
}

/// Returns the argument of a command that has this `shape` and sets the line's `key`. Throws
/// std::invalid_argument if the command does not have exactly one argument, or if the line has a serial port.
const std::string& new_value(const Control::ControlledLine& controlled, const Words& words,
                             const std::string& shape, const std::string& key) {
  if (words.size() != 2) {
    fail("expected " + shape);
  }
  if (controlled.has_serial_port) {
    fail("the line's serial port keeps its " + key + "; start the program with another " + key);
  }
  return words[1];
}

std::string on_line(const Control::ControlledLine& controlled, std::size_t position, const Words& words) {
  Line& line = controlled.line;
  if (words[0] == "sent" && words.size() == 1) {
    return std::to_string(controlled.sent ? controlled.sent() : 0);
  }
  if (words[0] == "faults" && words.size() == 1) {
    return list_faults(line, position);
  }
  if (words[0] == "baud") {
    line.master().set_baud(parse_baud_rate(new_value(controlled, words, "baud RATE", "rate")));
    return "";
  }
  if (words[0] == "format") {
    line.master().set_format(parse_line_format(new_value(controlled, words, "format FORMAT", "line format")));
    return "";
  }
  if (words[0] == "fault" && words.size() >= 2) {
    return words[1] == "off" ? end_fault(line, words)
                             : add_fault(line, std::nullopt, joined(Words(words.begin() + 1, words.end())));
  }
  fail("'" + joined(words) + "' is not a command; expected one of " + all_shapes());
}

std::string on_some_line(const Lines& lines, const Words& words) {
  if (words[0] != "line") {
    if (lines.size() != 1) {
      fail("there are several lines; put 'line NAME' before the command");
    }
    return on_line(lines[0], 0, words);
  }
  if (words.size() < 3) {
    fail("expected line NAME and a command of a line, for example line NAME faults");
  }
  std::size_t position = 0;
  for (const Control::ControlledLine& controlled : lines) {
    if (controlled.name == words[1]) {
      return on_line(controlled, position, Words(words.begin() + 2, words.end()));
    }
    position += controlled.line.size();
  }
  const std::string names = names_of(lines);
  fail("no line '" + words[1] + "'; " +
       (names.empty() ? "the only line has no name; leave out 'line NAME'" : "expected one of " + names));
}

std::string on_module(const Lines& lines, const Words& words) {
  std::size_t modules = 0;
  for (const Control::ControlledLine& controlled : lines) {
    modules += controlled.line.size();
  }
  const auto position = whole_number(words[0], modules);
  if (!position || *position == 0) {
    fail("no module " + words[0] + "; expected a position from 1 to " + std::to_string(modules));
  }
  if (words.size() == 1) {
    fail("'" + words[0] + "' is not a command; expected one of " + all_shapes());
  }
  std::size_t index = *position - 1;
  auto controlled = lines.begin();
  for (; index >= controlled->line.size(); ++controlled) {
    index -= controlled->line.size();
  }
  const Words args(words.begin() + 2, words.end());
  if (words[1] == "fault") {
    return add_fault(controlled->line, index, joined(args));
  }
  const Verb& verb = verb_called(words[1]);
  if (args.size() < verb.fewest || args.size() > verb.most) {
    fail("expected " + shape(verb));
  }
  return verb.handler(controlled->line.module(index), args);
}

}  // namespace

Control::Reply Control::carry_out(const std::string& command) {
  const Words words = words_of(command);
  const std::string first = words.empty() ? "" : words[0];
  try {
    if (command.find('\0') != std::string::npos) {
      fail("the command contains NUL; remove the NUL");
    }
    std::string result;
    if (first == "quit" || first == "list" || first == "help") {
      if (words.size() != 1) {
        fail("'" + first + "': expected no arguments");
      }
      result = first == "quit" ? "" : first == "list" ? list(lines_) : all_shapes();
    } else if (first == "advance") {
      fail("'advance' requires --speed step; without it, the lines' time advances by itself");
    } else if (first == "line" || first == "fault" || first == "faults" || first == "baud" ||
               first == "format" || first == "sent") {
      result = on_some_line(lines_, words);
    } else if (first.empty() || first.find_first_not_of("0123456789") != std::string::npos) {
      fail("'" + first + "' is not a command; expected one of " + all_shapes());
    } else {
      result = on_module(lines_, words);
    }
    return {"ok" + (result.empty() ? "" : " " + result), first == "quit"};
  } catch (const std::invalid_argument& error) {
    return {std::string("error: ") + error.what(), false};
  }
}

std::string control_commands() {
  std::ostringstream text;
  const auto row = [&text](std::string_view command, std::string_view does) {
    constexpr int kColumn = 20;
    text << "  " << std::left << std::setw(kColumn) << command << does << "\n";
  };
  for (const Verb& verb : kVerbs) {
    row(shape(verb), verb.does);
  }
  for (const Form& form : kOtherForms) {
    const std::string_view does = form.does;
    auto end = does.find('\n');
    row(form.shape, does.substr(0, end));
    while (end != std::string_view::npos) {
      const auto begin = end + 1;
      end = does.find('\n', begin);
      row("", does.substr(begin, end - begin));
    }
  }
  return text.str();
}

}  // namespace ex9000::sim
