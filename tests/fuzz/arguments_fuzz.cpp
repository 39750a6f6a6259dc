// Fuzzes the command line and bus files. An input that begins with `{` or `lines` is the text of a bus file.
// Any other input is a command line, and `|` separates two arguments. The result of each command line must be
// a simulator or another task to run, a text to print, or one line with an error. The target reads no file.
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/app/main/arguments.hpp"
#include "sim/app/setup/bus_file.hpp"
#include "sim/notation/fault_notation.hpp"
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
          "a module starts with settings that it could have stored");
  require(module.eeprom.find('\0') == std::string::npos, "a path contains no NUL");
  for (const sim::InputProgram& input : module.inputs) {
    require(input.channel < module.model->inputs, "an input that changes by itself is an input of the model");
    require(input.high.count() > 0 && input.bounce <= input.high,
            "an input is on for at least as long as it bounces");
  }
}

void check_line(const LineSetup& line) {
  require(!line.modules.empty(), "a line has at least one module");
  for (const ModuleSpec& module : line.modules) {
    check_module(module);
    const auto same_file = [&module](const ModuleSpec& other) {
      return !other.eeprom.empty() && other.eeprom == module.eeprom;
    };
    require(std::count_if(line.modules.begin(), line.modules.end(), same_file) <= 1,
            "no two modules of a line use the same EEPROM file");
  }
  require(line.serial() == nullptr || (line.ports.size() == 1 && !line.instant),
          "a serial port excludes other ports and an instant line");
  require(!line.instant || !line.strict_gaps, "an instant line has no strict gaps");
  for (const sim::PortSetup& port : line.ports) {
    const bool has_path = port.kind == sim::PortSetup::Kind::Pty || port.kind == sim::PortSetup::Kind::Serial;
    require(has_path ? !port.path.empty() && port.path.find('\0') == std::string::npos
                     : !port.address.host.empty(),
            "a port has a path without NUL, or an address with a host");
  }
  const auto is_rate = [&](std::uint32_t rate) { return rate == *line.baud; };
  require(!line.baud || std::any_of(kBaudRates.begin(), kBaudRates.end(), is_rate),
          "the line's baud rate is one of the eight baud rates");
  for (const sim::Fault& fault : line.faults) {
    require(!fault.module || *fault.module < line.modules.size(), "a fault belongs to an existing module");
    require(!fault.module || !fault.kind->is_of_the_line(), "a fault of the line belongs to no module");
    require(fault.text.find('\n') == std::string::npos, "the text of a fault is one line");
  }
}

void check_setup(const Setup& setup) {
  for (const LineSetup& line : setup.lines) {
    check_line(line);
    require(!setup.speed.max() || line.ports.empty(), "maximum speed excludes ports for a master");
  }
  require(!setup.speed.max() || setup.lasts, "maximum speed requires a duration");
  require(setup.speed.factor > 0, "the speed is greater than 0");
  require(!setup.speed.stepped() || setup.control, "stepped time requires a control socket");
  require(!setup.control || !setup.control->empty(), "a path is not empty");
}

/// Checks that each line has a name, and that the names are unique. Otherwise a user could not distinguish
/// the lines.
void check_several(const std::vector<LineSetup>& lines) {
  require(!lines.empty(), "a bus has at least one line");
  for (const LineSetup& line : lines) {
    require(!line.name.empty(), "each line of a bus file has a name");
    const auto is_like = [&line](const LineSetup& other) { return other.name == line.name; };
    require(std::count_if(lines.begin(), lines.end(), is_like) == 1, "line names are unique");
  }
}

void parse_file(const std::string& text) {
  try {
    Setup setup = sim::parse_bus_file("bus.json", text);
    sim::complete(setup);
    check_setup(setup);
    check_several(setup.lines);
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    const std::string place = "bus.json:";
    const auto end = what.find_first_not_of("0123456789", place.size());
    require(what.rfind(place, 0) == 0 && end > place.size() && what.compare(end, 2, ": ") == 0,
            "an error message about a bus file begins with the path and a line number");
    const auto lines = std::count(text.begin(), text.end(), '\n') + 1;
    const auto line = std::stol(what.substr(place.size(), end - place.size()));
    require(line >= 1 && line <= lines, "the line with this number exists in the file");
  }
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
  words.erase(std::remove_if(words.begin(), words.end(), sim::is_bus_file), words.end());
  std::vector<const char*> argv;
  for (const std::string& word : words) {
    argv.push_back(word.c_str());
  }
  argv.push_back(nullptr);
  const Parsed parsed = sim::parse_arguments(static_cast<int>(words.size()), argv.data());
  if (parsed.setup) {
    require(parsed.output.empty() && parsed.error.empty() && parsed.exit_status == 0,
            "a result with a setup has no text and no error");
    require(parsed.setup->lines.size() == 1, "a command line sets up exactly one RS-485 line");
    const LineSetup& line = parsed.setup->lines[0];
    require(parsed.setup->speed.max() || !line.ports.empty(), "the line has a port, except at maximum speed");
    check_setup(*parsed.setup);
  } else if (parsed.task) {
    require(parsed.output.empty() && parsed.error.empty() && parsed.exit_status == 0,
            "a result with a task has no text and no error");
    require(!parsed.task->bus || parsed.task->bus->lines.size() == 1,
            "the modules of the command play are on one line");
  } else if (!parsed.output.empty()) {
    require(parsed.error.empty() && parsed.exit_status == 0, "a result with a text has no error");
  } else {
    check_error(parsed);
  }
}

}  // namespace
}  // namespace ex9000::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (text[0] == '{' || text.rfind("lines", 0) == 0) {
    ex9000::fuzz::parse_file(text);
  } else {
    ex9000::fuzz::parse(text);
  }
  return 0;
}
