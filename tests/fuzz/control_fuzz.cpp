// Commands of the control socket, a line each, at three modules; `+N` in between is N times 10 ms. What is a
// command is judged here once more; what is none is refused in one line and changes nothing.
#include <chrono>
#include <sstream>
#include <string>
#include <vector>

#include "sim/control/control.hpp"
#include "sim/line.hpp"
#include "tests/fuzz/require.hpp"

namespace ex9000::fuzz {
namespace {

using sim::Line;
using sim::SimulatedModule;

const std::vector<sim::ModuleSpec>& specs() {
  static const std::vector<sim::ModuleSpec> kSpecs{sim::parse_module_spec("EX9042D"),
                                                   sim::parse_module_spec("EX9052D-M@02"),
                                                   sim::parse_module_spec("EX9055D@03")};
  return kSpecs;
}

/// What can be seen of a module from outside.
struct Seen {
  bool powered;
  std::uint16_t outputs;
  std::uint16_t inputs;
  bool led;
  std::uint64_t resets;
  bool listening;
  std::uint32_t latches;

  explicit Seen(const SimulatedModule& module)
      : powered(module.powered()),
        outputs(module.outputs()),
        inputs(module.input_levels()),
        led(module.led_lit()),
        resets(module.watchdog_resets()),
        listening(powered && module.module().listening()),
        latches(0) {
    if (powered) {
      const Inputs& its = module.module().state().inputs;
      latches = its.latched_high() + its.latched_low() * 65536U;
    }
  }
  bool operator==(const Seen& other) const {
    return powered == other.powered && outputs == other.outputs && inputs == other.inputs &&
           led == other.led && resets == other.resets && listening == other.listening &&
           latches == other.latches;
  }
};

std::vector<Seen> seen(Line& line) {
  std::vector<Seen> all;
  for (std::size_t i = 0; i < line.size(); ++i) {
    all.emplace_back(line.module(i));
  }
  return all;
}

bool is_number(const std::string& text, unsigned long least, unsigned long most) {
  if (text.empty() || text.size() > 9 || text.find_first_not_of("0123456789") != std::string::npos) {
    return false;
  }
  const unsigned long value = std::stoul(text);
  return value >= least && value <= most;
}

bool is_switch(const std::string& text) { return text == "on" || text == "off"; }

/// README's table of commands.
bool is_command(Line& line, const std::vector<std::string>& words) {
  if (words.empty()) {
    return false;
  }
  if (words[0] == "list" || words[0] == "help" || words[0] == "quit") {
    return words.size() == 1;
  }
  if (words.size() < 2 || !is_number(words[0], 1, line.size())) {
    return false;
  }
  const SimulatedModule& module = line.module(std::stoul(words[0]) - 1);
  const std::string& verb = words[1];
  const std::size_t args = words.size() - 2;
  const bool has_channel =
      args >= 1 && module.model().has_inputs() && is_number(words[2], 0, module.model().inputs - 1U);
  if (verb == "power" || verb == "init") {
    return args == 1 && is_switch(words[2]);
  }
  if (verb == "input") {
    return args == 2 && has_channel && is_switch(words[3]);
  }
  if (verb == "pulse") {
    return has_channel && (args == 1 || (args == 2 && is_number(words[3], 1, 1'000'000)));
  }
  if (verb == "reset" || verb == "hang") {
    return args == 0 && module.powered();
  }
  return args == 0 && (verb == "inputs" || verb == "outputs" || verb == "led" || verb == "status");
}

void check_effect(Line& line, const std::vector<std::string>& words, const std::string& reply) {
  if (words.size() < 2) {
    return;
  }
  const SimulatedModule& module = line.module(std::stoul(words[0]) - 1);
  if (words[1] == "power") {
    require(module.powered() == (words[2] == "on"), "power is on or off as told");
  } else if (words[1] == "input") {
    require((module.input_levels() >> std::stoul(words[2]) & 1U) == (words[3] == "on" ? 1U : 0U),
            "an input has the level it was told");
  } else if (words[1] == "status") {
    require(reply.find(std::string(module.model().designation)) == 3, "status tells the model");
  } else if (words[1] == "inputs" || words[1] == "outputs") {
    require(reply.size() == 7 && std::stoul(reply.substr(3), nullptr, 16) ==
                                     (words[1] == "inputs" ? module.input_levels() : module.outputs()),
            "levels are told in four hex digits");
  }
}

void carry_out(Line& line, sim::Control& control, const std::string& command) {
  std::istringstream stream(command);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  const bool valid = is_command(line, words);
  const std::vector<Seen> before = seen(line);
  const sim::Control::Reply reply = control.carry_out(command);
  require(reply.text.find('\n') == std::string::npos, "an answer is one line");
  require(reply.quit == (valid && words[0] == "quit"), "nothing else ends the program");
  if (valid) {
    require(reply.text == "ok" || reply.text.rfind("ok ", 0) == 0, "a command is carried out");
    check_effect(line, words, reply.text);
  } else {
    require(reply.text.rfind("error: ", 0) == 0, "what is no command is refused");
    require(before == seen(line), "what is refused changes nothing");
  }
}

void live(const std::string& text) {
  Line line(specs(), sim::kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  line.come_up();
  sim::Control control({{"", line}});
  std::istringstream lines(text);
  unsigned pulses = 0;
  for (std::string command; std::getline(lines, command);) {
    if (!command.empty() && command[0] == '+') {
      const std::string number = command.substr(1);
      const unsigned long times = is_number(number, 0, 99) ? std::stoul(number) : 1;
      line.bus().run_for(std::chrono::milliseconds(10) * static_cast<long>(times));
      continue;
    }
    // A million pulses are some milliseconds of work; one such command is enough.
    constexpr unsigned kMostLong = 1;
    if (command.find("pulse") != std::string::npos &&
        command.find_first_of("0123456789", command.find("pulse")) != std::string::npos &&
        command.size() > command.find("pulse") + 12 && ++pulses > kMostLong) {
      continue;
    }
    carry_out(line, control, command);
  }
}

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ex9000::fuzz::live(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
