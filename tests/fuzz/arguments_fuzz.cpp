// The command line: `|` in the input is where one argument ends and the next begins. Whatever it is, it comes
// to something to do, to text, or to one line that says what is wrong, and only to that.
#include <algorithm>
#include <string>
#include <vector>

#include "sim/arguments.hpp"
#include "tests/fuzz/require.hpp"

namespace ex9000::fuzz {
namespace {

using sim::LineSetup;
using sim::ModuleSpec;
using sim::Parsed;
using sim::Setup;

void check_error(const Parsed& parsed) {
  const std::string& error = parsed.error;
  require(parsed.exit_status == sim::kWrongArguments, "wrong arguments end with status 2");
  require(!parsed.setup && parsed.output.empty(), "wrong arguments have no effect");
  require(error.rfind("ex9000-sim: ", 0) == 0 && error.size() > sizeof "ex9000-sim: ",
          "an error says what is wrong");
  require(std::count(error.begin(), error.end(), '\n') == 1 && error.back() == '\n', "an error is one line");
}

void check_module(const ModuleSpec& module) {
  require(module.model != nullptr && module.settings.possible_for(*module.model),
          "a module starts with settings it could have stored");
  require(module.eeprom.find('\0') == std::string::npos, "a path is a path");
}

void check_line(const LineSetup& line) {
  require(!line.modules.empty(), "there is a module");
  for (const ModuleSpec& module : line.modules) {
    check_module(module);
    const auto same_file = [&module](const ModuleSpec& other) {
      return !other.eeprom.empty() && other.eeprom == module.eeprom;
    };
    require(std::count_if(line.modules.begin(), line.modules.end(), same_file) <= 1,
            "each EEPROM has a file of its own");
  }
  require(line.pty || line.tcp || line.serial, "there is a way to the line");
  require(!line.serial || (!line.pty && !line.tcp && !line.instant), "a real line is the only one");
  require(!line.echo || line.serial, "only a serial port has an echo");
  require(!line.instant || !line.strict_gaps, "gaps mean nothing where bytes cost no time");
  for (const auto& path : {line.pty, line.serial}) {
    require(!path || !path->empty(), "a path is not empty");
  }
  const auto is_rate = [&](std::uint32_t rate) { return rate == *line.baud; };
  require(!line.baud || std::any_of(kBaudRates.begin(), kBaudRates.end(), is_rate),
          "the line's rate is one of eight");
  require(!line.tcp || !line.tcp->host.empty(), "TCP has a host");
  for (const sim::Fault& fault : line.faults) {
    require(!fault.module || *fault.module < line.modules.size(), "a fault is of a module that there is");
    require(!fault.module || sim::befalls_a_module(fault.trouble), "what befalls the line is of no module");
  }
}

void check_setup(const Setup& setup) {
  require(setup.lines.size() == 1, "a command line has one line");
  check_line(setup.lines[0]);
  require(!setup.control || !setup.control->empty(), "a path is not empty");
}

void parse(const std::string& text) {
  std::vector<std::string> words{"ex9000-sim"};
  if (!text.empty()) {
    std::size_t at = 0;
    for (std::size_t end = text.find('|'); end != std::string::npos; end = text.find('|', at)) {
      words.push_back(text.substr(at, end - at));
      at = end + 1;
    }
    words.push_back(text.substr(at));
  }
  std::vector<const char*> argv;
  for (const std::string& word : words) {
    argv.push_back(word.c_str());
  }
  argv.push_back(nullptr);
  const Parsed parsed = sim::parse_arguments(static_cast<int>(words.size()), argv.data());
  if (parsed.setup) {
    require(parsed.output.empty() && parsed.error.empty() && parsed.exit_status == 0,
            "something to do is all there is");
    check_setup(*parsed.setup);
  } else if (!parsed.output.empty()) {
    require(parsed.error.empty() && parsed.exit_status == 0, "text is all there is");
  } else {
    check_error(parsed);
  }
}

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ex9000::fuzz::parse(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
