#include "sim/control/control.hpp"

#include <array>
#include <iomanip>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

namespace ex9000::sim {

namespace {

using Words = std::vector<std::string>;

/// Becomes an `error: ` reply.
struct Refused {
  std::string why;  ///< may hold any byte that a command may
};

constexpr unsigned long kMostPulses = 1'000'000;  // some milliseconds of work

Words words_of(const std::string& line) {
  std::istringstream stream(line);
  Words words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

/// Decimal digits and nothing else, up to `most`.
std::optional<unsigned long> number(const std::string& text, unsigned long most) {
  constexpr std::size_t kMostDigits = 9;
  if (text.empty() || text.size() > kMostDigits ||
      text.find_first_not_of("0123456789") != std::string::npos) {
    return std::nullopt;
  }
  const unsigned long value = std::stoul(text);
  return value <= most ? std::optional(value) : std::nullopt;
}

bool on_off(const std::string& word) {
  if (word != "on" && word != "off") {
    throw Refused{"'" + word + "' is neither on nor off"};
  }
  return word == "on";
}

unsigned input_channel(const SimulatedModule& module, const std::string& word) {
  const unsigned inputs = module.model().inputs;
  const auto channel = inputs == 0 ? std::nullopt : number(word, inputs - 1);
  if (!channel) {
    throw Refused{"the " + std::string(module.model().designation) + " has no input " + word +
                  (inputs == 0 ? ", it has none at all" : "; it has 0 to " + std::to_string(inputs - 1))};
  }
  return static_cast<unsigned>(*channel);
}

void want_power(const SimulatedModule& module) {
  if (!module.powered()) {
    throw Refused{"the module has no power; 'power on' comes first"};
  }
}

std::string power(SimulatedModule& module, const Words& args) {
  module.power(on_off(args[0]));
  return "";
}

std::string reset(SimulatedModule& module, const Words& /*args*/) {
  want_power(module);
  module.reset();
  return "";
}

std::string init(SimulatedModule& module, const Words& args) {
  module.set_init(on_off(args[0]));
  return "";
}

std::string input(SimulatedModule& module, const Words& args) {
  const unsigned channel = input_channel(module, args[0]);
  module.set_input(channel, on_off(args[1]));
  return "";
}

std::string pulse(SimulatedModule& module, const Words& args) {
  const unsigned channel = input_channel(module, args[0]);
  const auto count = args.size() == 1 ? std::optional(1UL) : number(args[1], kMostPulses);
  if (!count || *count == 0) {
    throw Refused{"'" + args[1] + "' is no count from 1 to " + std::to_string(kMostPulses)};
  }
  module.pulse_input(channel, static_cast<std::uint32_t>(*count));
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
  want_power(module);
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
       << " baud=" << baud_rate(in_force.baud_code) << " checksum=" << (in_force.checksum ? "on" : "off")
       << " mode=" << (in_force.init_mode ? "init" : "normal")
       << " host-watchdog=" << host_watchdog(state.settings) << " timeout=" << std::fixed
       << std::setprecision(1) << state.settings.watchdog_timeout / 10.0
       << "s watchdog-resets=" << module.watchdog_resets();
  return text + rest.str();
}

/// What follows the position of a module.
struct Verb {
  std::string_view name;
  std::string_view args;
  std::size_t fewest;
  std::size_t most;
  std::string_view does;
  std::string (*handler)(SimulatedModule& module, const Words& args);
};

constexpr std::array<Verb, 10> kVerbs{{
    {"power", "on|off", 1, 1, "the supply", power},
    {"reset", "", 0, 0, "a reset without loss of power", reset},
    {"init", "on|off", 1, 1, "INIT* tied to GND, or released", init},
    {"input", "C on|off", 2, 2, "level of input C, from 0", input},
    {"pulse", "C [COUNT]", 1, 2, "full pulses on input C, from its level and back, all at once", pulse},
    {"inputs", "", 0, 0, "levels, hex: bit n is input n", inputs},
    {"outputs", "", 0, 0, "what is driven, hex: bit n is output n", outputs},
    {"led", "", 0, 0, "the status LED: on, off or flashing", led},
    {"hang", "", 0, 0, "the main loop stops being run, until the module watchdog resets it", hang},
    {"status", "", 0, 0, "address, protocol, rate, mode and watchdogs", status},
}};

std::string shape(const Verb& verb) {
  return "N " + std::string(verb.name) + (verb.args.empty() ? "" : " ") + std::string(verb.args);
}

std::string all_shapes() {
  std::string text;
  for (const Verb& verb : kVerbs) {
    text += shape(verb) + ", ";
  }
  return text + "list, help, quit";
}

std::string where(const SimulatedModule& module) {
  if (!module.powered()) {
    return " without power";
  }
  return module.module().listening() ? " at " + hex_byte_text(module.module().state().in_force.address)
                                     : " starting";
}

std::string list(Line& line) {
  std::string text = std::to_string(line.size()) + (line.size() == 1 ? " module:" : " modules:");
  for (std::size_t i = 0; i < line.size(); ++i) {
    const SimulatedModule& module = line.module(i);
    text += std::string(i == 0 ? " " : ", ") + std::to_string(i + 1) + " " +
            std::string(module.model().designation) + where(module);
  }
  return text;
}

const Verb& verb_called(const std::string& name) {
  for (const Verb& verb : kVerbs) {
    if (verb.name == name) {
      return verb;
    }
  }
  throw Refused{"no command '" + name + "'; there are " + all_shapes()};
}

std::string on_module(Line& line, const Words& words) {
  const auto position = number(words[0], line.size());
  if (!position || *position == 0) {
    throw Refused{"no module " + words[0] + "; this line has 1 to " + std::to_string(line.size())};
  }
  if (words.size() == 1) {
    throw Refused{"'" + words[0] + "' alone is no command; there are " + all_shapes()};
  }
  const Verb& verb = verb_called(words[1]);
  const Words args(words.begin() + 2, words.end());
  if (args.size() < verb.fewest || args.size() > verb.most) {
    throw Refused{"the command is " + shape(verb)};
  }
  return verb.handler(line.module(*position - 1), args);
}

}  // namespace

Control::Reply Control::carry_out(const std::string& command) {
  const Words words = words_of(command);
  const std::string first = words.empty() ? "" : words[0];
  try {
    std::string result;
    const bool quit = first == "quit";
    if (quit || first == "list" || first == "help") {
      if (words.size() != 1) {
        throw Refused{"nothing goes behind '" + first + "'"};
      }
      result = quit ? "" : first == "list" ? list(line_) : all_shapes();
    } else if (first.empty() || first.find_first_not_of("0123456789") != std::string::npos) {
      throw Refused{"no command '" + first + "'; there are " + all_shapes()};
    } else {
      result = on_module(line_, words);
    }
    return {"ok" + (result.empty() ? "" : " " + result), quit};
  } catch (const Refused& refused) {
    return {"error: " + refused.why, false};
  }
}

std::string control_commands() {
  std::ostringstream text;
  const auto row = [&text](const std::string& command, std::string_view does) {
    constexpr int kColumn = 20;
    text << "  " << std::left << std::setw(kColumn) << command << does << "\n";
  };
  for (const Verb& verb : kVerbs) {
    row(shape(verb), verb.does);
  }
  row("list", "the modules");
  row("help", "the commands");
  row("quit", "ends the simulator");
  return text.str();
}

}  // namespace ex9000::sim
