#include "sim/notation/actions.hpp"

#include <algorithm>
#include <iomanip>
#include <iterator>
#include <limits>
#include <sstream>
#include <string_view>

#include "sim/notation/fault_notation.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// What an action acts on.
struct Place {
  const LineInUse& in_use;
  std::size_t index = 0;         ///< of the module on the line, from 0
  std::size_t first_module = 0;  ///< the position of the line's first module across all lines, from 0

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
};

std::string host_watchdog(const Settings& settings) {
  return settings.timeout_status ? "expired" : settings.watchdog_enabled ? "enabled" : "disabled";
}

std::string status(const Place& place, const Words& /*args*/) {
  const SimulatedModule& module = place.module();
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

std::string led(const Place& place, const Words& /*args*/) {
  const SimulatedModule& module = place.module();
  if (!module.powered()) {
    return "off";
  }
  return module.module().led_pattern() == StatusLed::Pattern::Steady ? "on" : "flashing";
}

/// Returns the results of `number_of` for all channels, separated by spaces.
template <class NumberOf>
std::string for_each_channel(unsigned channels, NumberOf number_of) {
  Words numbers;
  for (unsigned channel = 0; channel < channels; ++channel) {
    numbers.push_back(std::to_string(number_of(channel)));
  }
  return joined(numbers);
}

std::string end_fault(Line& line, const std::string& which) {
  constexpr std::uint64_t kMostFaults = 999'999'999;
  const auto fault = whole_number(which, kMostFaults);
  if (which == "all") {
    line.faults().remove_all();
  } else if (!fault) {
    fail("expected fault off K|all");
  } else if (!line.faults().remove(*fault)) {
    throw NotNow("no fault " + which + " on this line");
  }
  return "";
}

std::string change_faults(const Place& place, const Words& args) {
  if (args[0] == "off") {
    return end_fault(place.line(), args.size() == 2 ? args[1] : "");
  }
  return std::to_string(place.line().faults().add(parse_fault(joined(args))));
}

std::string list_faults(const Place& place, const Words& /*args*/) {
  const std::vector<Faults::Info> faults = place.line().faults().list();
  std::string text = std::to_string(faults.size()) + (faults.size() == 1 ? " fault:" : " faults:");
  for (const Faults::Info& fault : faults) {
    text += (&fault == faults.data() ? " " : "; ") + std::to_string(fault.number) +
            (fault.in_progress != 0 ? "*" : "") + " x" + std::to_string(fault.occurrences_so_far) + " " +
            (fault.module ? std::to_string(place.first_module + *fault.module + 1) + " " : "") + fault.text;
  }
  return text;
}

struct Action {
  std::string_view name;
  std::string_view args;
  std::size_t fewest;
  std::size_t most;
  bool changes;  ///< false: only reads
  std::string_view does;
  std::string (*act)(const Place& place, const Words& args);

  [[nodiscard]] std::string shape() const {
    return std::string(name) + (args.empty() ? "" : " ") + std::string(args);
  }
};

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();

constexpr Action kModuleActions[] = {
    {"power", "on|off", 1, 1, true, "switches the supply",
     [](const Place& place, const Words& args) -> std::string {
       place.module().power(parse_on_off(args[0]));
       return "";
     }},
    {"reset", "", 0, 0, true, "resets the module; the supply stays on",
     [](const Place& place, const Words& /*args*/) -> std::string {
       place.powered_module().reset();
       return "";
     }},
    {"init", "on|off", 1, 1, true, "ties INIT* to GND, or releases it",
     [](const Place& place, const Words& args) -> std::string {
       place.module().set_init(parse_on_off(args[0]));
       return "";
     }},
    {"input", "C on|off", 2, 2, true, "sets the level of input C, from 0",
     [](const Place& place, const Words& args) -> std::string {
       place.module().set_input(parse_input(args[0], place.module().model()), parse_on_off(args[1]));
       return "";
     }},
    {"pulse", "C [xCOUNT]", 1, 2, true, "applies COUNT full pulses to input C at once (default 1)",
     [](const Place& place, const Words& args) -> std::string {
       const unsigned channel = parse_input(args[0], place.module().model());
       place.module().pulse_input(channel, parse_pulses(args).count);
       return "";
     }},
    {"fault", "FAULT", 1, kAny, true,
     "adds a fault of the module, see 'help faults'; replies with its number",
     [](const Place& place, const Words& args) {
       return std::to_string(place.line().faults().add(parse_fault(joined(args), place.index)));
     }},
    {"hang", "", 0, 0, true, "stops the main loop until the module watchdog resets the module",
     [](const Place& place, const Words& /*args*/) -> std::string {
       place.powered_module().hang();
       return "";
     }},
    {"inputs", "", 0, 0, false, "reads the input levels in hex; bit n is input n",
     [](const Place& place, const Words& /*args*/) { return hex_word_text(place.module().input_levels()); }},
    {"outputs", "", 0, 0, false, "reads the outputs in hex; bit n is output n",
     [](const Place& place, const Words& /*args*/) { return hex_word_text(place.module().outputs()); }},
    {"timers", "", 0, 0, false,
     "reads the remaining time of each output's timer in 0.1 s; 0: it does not run",
     [](const Place& place, const Words& /*args*/) {
       const OutputTimers& timers = place.powered_module().module().state().output_timers;
       return for_each_channel(place.module().model().outputs,
                               [&](unsigned channel) { return timers.left(channel); });
     }},
    {"filters", "", 0, 0, false, "reads the filter of each input in ms",
     [](const Place& place, const Words& /*args*/) {
       const InputFilters& filters = place.powered_module().module().state().settings.input_filters;
       return for_each_channel(place.module().model().inputs,
                               [&](unsigned channel) { return filters.of(channel); });
     }},
    {"led", "", 0, 0, false, "reads the status LED: on, off or flashing", led},
    {"status", "", 0, 0, false, "reads the model, the settings in force, the mode and the watchdogs", status},
};

constexpr Action kLineActions[] = {
    {"baud", "RATE", 1, 1, true, "sets the line's baud rate until a pseudo-terminal sets it",
     [](const Place& place, const Words& args) -> std::string {
       place.own_master().set_baud(parse_baud_rate(args[0]));
       return "";
     }},
    {"format", "FORMAT", 1, 1, true, "sets the line's format: 8N1, 8N2, 8E1 or 8O1",
     [](const Place& place, const Words& args) -> std::string {
       place.own_master().set_format(parse_line_format(args[0]));
       return "";
     }},
    {"fault", "FAULT", 1, kAny, true,
     "adds a fault of the line or of all its modules; replies with its number", change_faults},
    {"fault off", "K|all", 1, 1, true, "removes the fault with this number, or all faults", nullptr},
    {"faults", "", 0, 0, false,
     "lists the faults: number, * if in progress, x and number of occurrences, module, text", list_faults},
    {"sent", "", 0, 0, false, "reads how many bytes the line has written to each of its ports",
     [](const Place& place, const Words& /*args*/) {
       return std::to_string(place.in_use.sent ? place.in_use.sent() : 0);
     }},
};

[[noreturn]] void refuse(const Words& words) {
  fail("'" + joined(words) + "' is not a command; expected one of " + joined(action_shapes(), ", "));
}

/// `said`: the command for the log. `lead`: stands before the shape of the action in a message.
template <std::size_t kSize>
std::string act(const Action (&actions)[kSize], const Place& place, const Words& words,
                const std::string& lead, const std::string& said) {
  for (const Action& action : actions) {
    if (action.name != words[0]) {
      continue;
    }
    const Words args(words.begin() + 1, words.end());
    if (args.size() < action.fewest || args.size() > action.most) {
      fail("expected " + lead + action.shape());
    }
    std::string result = action.act(place, args);
    if (action.changes && place.in_use.note) {
      place.in_use.note(said);
    }
    return result;
  }
  refuse(words);
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
    refuse(words);
  }
  std::size_t index = *position - 1;
  auto each = lines.begin();
  for (; index >= each->line.size(); ++each) {
    index -= each->line.size();
  }
  return act(kModuleActions, {*each, index, 0}, Words(words.begin() + 1, words.end()), "N ", joined(words));
}

std::string on_line(const LinesInUse& lines, const Words& words) {
  if (words[0] != "line") {
    if (lines.size() != 1) {
      fail("there are several lines; put 'line NAME' before the command");
    }
    return act(kLineActions, {lines[0]}, words, "", joined(words));
  }
  if (words.size() < 3) {
    fail("expected line NAME and a command of a line, for example line NAME faults");
  }
  std::size_t first_module = 0;
  for (const LineInUse& each : lines) {
    if (each.name == words[1]) {
      const Words action(words.begin() + 2, words.end());
      return act(kLineActions, {each, 0, first_module}, action, "", joined(action));
    }
    first_module += each.line.size();
  }
  const std::string names = names_of(lines);
  fail("no line '" + words[1] + "'; " +
       (names.empty() ? "the only line has no name; leave out 'line NAME'" : "expected one of " + names));
}

bool is_number(const std::string& word) { return word.find_first_not_of("0123456789") == std::string::npos; }

bool is_of_a_line(const std::string& word) {
  const auto is_it = [&](const Action& action) { return action.name == word; };
  return word == "line" || std::any_of(std::begin(kLineActions), std::end(kLineActions), is_it);
}

}  // namespace

std::string act(const LinesInUse& lines, const Words& words) {
  if (words.empty() || (!is_number(words[0]) && !is_of_a_line(words[0]))) {
    fail("'" + (words.empty() ? "" : words[0]) + "' is not a command; expected one of " +
         joined(action_shapes(), ", "));
  }
  return is_number(words[0]) ? on_module(lines, words) : on_line(lines, words);
}

bool only_reads(const std::string& name) {
  const auto reads = [&](const Action& action) { return action.name == name && !action.changes; };
  return std::any_of(std::begin(kModuleActions), std::end(kModuleActions), reads) ||
         std::any_of(std::begin(kLineActions), std::end(kLineActions), reads);
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

Words action_shapes() {
  Words shapes;
  for (const Action& action : kModuleActions) {
    shapes.push_back("N " + action.shape());
  }
  for (const Action& action : kLineActions) {
    shapes.push_back(action.shape());
  }
  return shapes;
}

std::string action_help() {
  constexpr int kColumn = 20;
  std::ostringstream text;
  const auto row = [&text](const std::string& shape, const Action& action) {
    text << "  " << std::left << std::setw(kColumn) << shape << action.does << "\n";
  };
  for (const Action& action : kModuleActions) {
    row("N " + action.shape(), action);
  }
  for (const Action& action : kLineActions) {
    row(action.shape(), action);
  }
  return text.str();
}

}  // namespace ex9000::sim
