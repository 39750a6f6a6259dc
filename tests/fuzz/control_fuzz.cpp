// Carries out commands of the control socket for a simulated line with three modules. Each line of the input
// text is one command, unless it begins with `+`: `+N` lets N times 10 ms pass if N is 0 to 99, and any other
// text after `+` lets 10 ms pass. RunTimeLimit limits these times and the commands with many pulses. The
// target decides independently of the simulator whether a command is valid. Each command must receive a reply
// of one line. An invalid command must receive an error and must change nothing.
#include <array>
#include <chrono>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "sim/front_ends/control_socket/control.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/fuzz/fault_judge.hpp"
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

/// The part of a module's state that is visible from outside.
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
  const auto value = fault::number<unsigned long>(text);
  return value && *value >= least && *value <= most;
}

bool is_switch(const std::string& text) { return text == "on" || text == "off"; }

std::optional<LineFormat> format_called(const std::string& text) {
  constexpr std::array<const char*, 4> kNames{"8N1", "8N2", "8E1", "8O1"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const std::string name = kNames[i];
    if (text == name || text == name.substr(0, 1) + static_cast<char>(name[1] + ('n' - 'N')) + name[2]) {
      return static_cast<LineFormat>(i);
    }
  }
  return std::nullopt;
}

/// The line, and its faults according to the commands so far.
struct Watched {
  Line line{specs(), sim::kPaced, [this](std::uint8_t /*byte*/, ByteStatus /*status*/) { ++heard; }};
  unsigned long heard = 0;  ///< bytes received at the master's end
  std::set<unsigned long> faults;
  unsigned long numbers = 0;
};

/// Returns whether the words are a command that `line NAME` may precede.
bool is_of_the_line(const Watched& watched, Words words, sim::VirtualTime now) {
  if (words.size() == 1) {
    return words[0] == "faults" || words[0] == "sent";
  }
  if (words.size() == 2 && words[0] == "baud") {
    return fault::is_rate(words[1]);
  }
  if (words.size() == 2 && words[0] == "format") {
    return format_called(words[1]).has_value();
  }
  if (words.empty() || words[0] != "fault") {
    return false;
  }
  if (words[1] == "off") {
    return words.size() == 3 && (words[2] == "all" || (is_number(words[2], 1, 999'999'999) &&
                                                       watched.faults.count(std::stoul(words[2])) != 0));
  }
  words.erase(words.begin());
  return is_fault(words, Whose::AnyModules, now);
}

/// Returns the words without a leading `line NAME`. Returns no words if NAME is not `hall`, or if no command
/// follows.
Words of_the_line(const Words& words) {
  if (words[0] != "line") {
    return words;
  }
  return words.size() >= 3 && words[1] == "hall" ? Words(words.begin() + 2, words.end()) : Words();
}

/// xCOUNT, with at least `least` pulses.
bool is_pulse_count(const std::string& word, unsigned long least) {
  return word[0] == 'x' && is_number(word.substr(1), least, 1'000'000);
}

/// Returns whether the words are a valid command according to sim/docs/control-socket.md. `advance` is never
/// valid here, because it requires stepped time.
bool is_command(Watched& watched, const Words& words) {
  Line& line = watched.line;
  const sim::VirtualTime now = line.clock().virtual_now();
  if (words.empty()) {
    return false;
  }
  if (words[0] == "list" || words[0] == "help" || words[0] == "quit") {
    return words.size() == 1;
  }
  if (words[0] == "line" || words[0] == "fault" || words[0] == "faults" || words[0] == "baud" ||
      words[0] == "format" || words[0] == "sent") {
    return is_of_the_line(watched, of_the_line(words), now);
  }
  if (words.size() < 2 || !is_number(words[0], 1, line.size())) {
    return false;
  }
  const SimulatedModule& module = line.module(std::stoul(words[0]) - 1);
  const std::string& verb = words[1];
  const std::size_t args = words.size() - 2;
  if (verb == "fault") {
    return is_fault(Words(words.begin() + 2, words.end()), Whose::ThisModules, now);
  }
  const bool has_channel =
      args >= 1 && module.model().has_inputs() && is_number(words[2], 0, module.model().inputs - 1U);
  if (verb == "power" || verb == "init") {
    return args == 1 && is_switch(words[2]);
  }
  if (verb == "input") {
    return args == 2 && has_channel && is_switch(words[3]);
  }
  if (verb == "pulse") {
    return has_channel && (args == 1 || (args == 2 && is_pulse_count(words[3], 1)));
  }
  if (verb == "reset" || verb == "hang" || verb == "timers" || verb == "filters") {
    return args == 0 && module.powered();
  }
  return args == 0 && (verb == "inputs" || verb == "outputs" || verb == "led" || verb == "status");
}

/// Checks the reply to a command that adds or lists faults. Updates the expected faults after a command that
/// adds or removes faults.
void check_faults(Watched& watched, const Words& words, const std::string& reply) {
  if (words[0] == "faults") {
    const std::size_t number = watched.faults.size();
    require(reply.rfind("ok " + std::to_string(number) + (number == 1 ? " fault:" : " faults:"), 0) == 0,
            "the reply begins with the number of faults");
  } else if (words[1] != "off") {
    require(reply == "ok " + std::to_string(++watched.numbers), "faults are numbered one after the other");
    watched.faults.insert(watched.numbers);
  } else if (words[2] == "all") {
    watched.faults.clear();
  } else {
    watched.faults.erase(std::stoul(words[2]));
  }
}

void check_effect(Watched& watched, const Words& words, const std::string& reply) {
  const Words on_line = of_the_line(words);
  if (on_line[0] == "baud") {
    require(watched.line.master().mode().baud == std::stoul(on_line[1]),
            "the line has the requested baud rate");
    return;
  }
  if (on_line[0] == "format") {
    require(watched.line.master().mode().format == format_called(on_line[1]),
            "the line has the requested format");
    return;
  }
  if (on_line[0] == "sent") {
    require(reply == "ok 0", "a line without ports has sent nothing to ports");
    return;
  }
  if (on_line[0] == "fault" || on_line[0] == "faults") {
    check_faults(watched, on_line, reply);
    return;
  }
  if (words.size() < 2) {
    return;
  }
  const SimulatedModule& module = watched.line.module(std::stoul(words[0]) - 1);
  if (words[1] == "fault") {
    check_faults(watched, Words(words.begin() + 1, words.end()), reply);
  } else if (words[1] == "power") {
    // An active fault may interrupt the supply of a module that is switched on.
    require(module.powered() ? words[2] == "on" : words[2] == "off" || !watched.faults.empty(),
            "the supply has the requested state");
  } else if (words[1] == "input") {
    require((module.input_levels() >> std::stoul(words[2]) & 1U) == (words[3] == "on" ? 1U : 0U),
            "an input has the requested level");
  } else if (words[1] == "status") {
    require(reply.find(std::string(module.model().designation)) == 3, "the status contains the model");
  } else if (words[1] == "inputs" || words[1] == "outputs") {
    require(reply.size() == 7 && std::stoul(reply.substr(3), nullptr, 16) ==
                                     (words[1] == "inputs" ? module.input_levels() : module.outputs()),
            "levels are printed as four hex digits");
  }
}

Words words_of(const std::string& command) {
  std::istringstream stream(command);
  Words words;
  for (std::string word; stream >> word;) {
    words.push_back(word);
  }
  return words;
}

void carry_out(Watched& watched, sim::Control& control, const std::string& command, const Words& words) {
  Line& line = watched.line;
  const bool valid = is_command(watched, words);
  const std::vector<Seen> before = seen(line);
  const sim::Control::Reply reply = control.carry_out(command);
  require(reply.text.find('\n') == std::string::npos, "a reply is one line");
  require(reply.quit == (valid && words[0] == "quit"), "only the command quit ends the program");
  if (valid) {
    require(reply.text == "ok" || reply.text.rfind("ok ", 0) == 0, "a valid command is carried out");
    check_effect(watched, words, reply.text);
  } else {
    require(reply.text.rfind("error: ", 0) == 0, "an invalid command is rejected");
    require(before == seen(line), "a rejected command changes nothing");
  }
}

/// Limits the run time, because slow inputs find few errors.
class RunTimeLimit {
 public:
  /// Lets up to `steps` steps of 10 ms pass, but at most 2 s in all calls together. This is enough for the
  /// module watchdog, which resets a module after 1.6 s. Lets no more time pass after the master has received
  /// 200 bytes.
  void pass(Watched& watched, unsigned long steps) {
    constexpr unsigned long kMostHeard = 200;
    for (; steps != 0 && steps_left_ != 0 && watched.heard < kMostHeard; --steps, --steps_left_) {
      watched.line.wires().run_for(std::chrono::milliseconds(10));
    }
  }
  /// Returns whether the command may run. Of the commands with 100 to 99,999 pulses, only the first one in
  /// the input of the target may run. A command with 100,000 to 1,000,000 pulses may not run.
  bool permits(const Words& words) {
    const bool pulses = words.size() == 4 && words[1] == "pulse" && is_pulse_count(words[3], 100);
    return !pulses || (std::stoul(words[3].substr(1)) <= 99'999 && !std::exchange(used_, true));
  }

 private:
  bool used_ = false;
  unsigned long steps_left_ = 200;
};

void live(const std::string& text) {
  Watched watched;
  watched.line.come_up();
  sim::Control control({{"hall", watched.line}});
  std::istringstream lines(text);
  RunTimeLimit limit;
  for (std::string command; std::getline(lines, command);) {
    if (!command.empty() && command[0] == '+') {
      const std::string number = command.substr(1);
      limit.pass(watched, is_number(number, 0, 99) ? std::stoul(number) : 1);
      continue;
    }
    const Words words = words_of(command);
    if (limit.permits(words)) {
      carry_out(watched, control, command, words);
    }
  }
}

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ex9000::fuzz::live(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
