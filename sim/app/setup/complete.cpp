#include <algorithm>
#include <set>
#include <utility>

#include "sim/app/setup/setup.hpp"
#include "sim/files_and_ports/files/one_spelling.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using Kind = PortSetup::Kind;

/// Names the lines of a bus file, and gives each line without a port a pseudo-terminal.
void add_defaults(Setup& setup) {
  for (std::size_t i = 0; i < setup.lines.size(); ++i) {
    LineSetup& line = setup.lines[i];
    for (std::size_t position = 0; position < line.modules.size(); ++position) {
      constexpr std::size_t kMostOnALine = 0x100;
      std::uint32_t& number = line.modules[position].serial_number;
      const auto low = static_cast<std::uint16_t>(i * kMostOnALine + position + 1);
      number = number != 0 ? number : serial_number_of(low);
    }
    if (line.name.empty() && !setup.file.empty()) {
      line.name = "line" + std::to_string(i + 1);
    }
    if (line.ports.empty() && !setup.speed.max()) {
      PortSetup port;
      port.path = (line.name.empty() ? "ex9000" : line.name) + ".tty";
      port.text = "pty:" + port.path;
      port.place = place_of(line.places, "port");
      line.ports.push_back(port);
    }
  }
}

void check_ports(const LineSetup& line, const Speed& speed) {
  const PortSetup* serial = line.serial();
  for (const PortSetup& port : line.ports) {
    if (serial != nullptr && &port != serial) {
      fail(port.place + port.text + ": cannot be combined with " + serial->text +
           ", because the master is on the serial line; leave out one of them");
    }
    if (speed.max()) {
      fail(port.place + port.text +
           ": cannot be combined with speed max, because masters follow the wall clock; leave out one of "
           "them");
    }
    if (port.wait && speed.stepped()) {
      fail(port.place + port.text +
           ": wait cannot be combined with speed step, because 'advance TIME after N' waits for masters; "
           "leave out one of them");
    }
  }
  if (serial != nullptr && line.instant) {
    fail(place_of(line.places, "timing") + "instant cannot be combined with " + serial->text +
         ", because bytes on a serial line take time; leave out one of them");
  }
  if (serial != nullptr && !(speed.paced() && speed.factor == 1)) {
    fail(serial->place + serial->text +
         ": requires speed 1, because a serial line follows the wall clock; leave out one of them");
  }
}

/// Against the control socket, the panel and the duration.
void check_speed(const Setup& setup) {
  const auto wrong = [&setup](const std::string& what) { fail(place_of(setup.places, "speed") + what); };
  if (setup.speed.stepped() && !setup.control) {
    wrong("step requires control, because only the control socket advances the time");
  }
  if (setup.speed.stepped() && setup.panel) {
    wrong(
        "step cannot be combined with panel, which shows time that follows the wall clock; leave out one of "
        "them");
  }
  if (setup.speed.max() && (setup.control || setup.panel)) {
    wrong("max cannot be combined with control or panel; leave out one of them");
  }
  if (setup.speed.max() && !setup.lasts) {
    wrong("max requires for, for example 10s");
  }
}

/// Rejects a path, address or name that is given twice.
class Once {
 public:
  explicit Once(std::string problem) : problem_(std::move(problem)) {}

  void add(const std::string& place, const std::string& name, const std::string& identity) {
    if (!name.empty() && !seen_.insert(identity).second) {
      fail(place + name + ": " + problem_);
    }
  }
  void add_path(const std::string& place, const std::string& path) { add(place, path, one_spelling(path)); }

 private:
  std::string problem_;
  std::set<std::string> seen_;
};

void check_uses(const Setup& setup) {
  Once paths("is already used; name another path");
  Once addresses("two ports cannot share an address; name one for each");
  Once names("two lines have this name; give each line a different name");
  for (const LineSetup& line : setup.lines) {
    names.add(place_of(line.places, "name"), line.name, line.name);
    for (const PortSetup& port : line.ports) {
      paths.add_path(port.place, port.path);
      if (port.address.port != 0) {
        addresses.add(port.place, port.text, port.address.host + ":" + std::to_string(port.address.port));
      }
    }
    for (const ModuleSpec& module : line.modules) {
      paths.add_path(place_of(module.places, "eeprom"), module.eeprom);
    }
  }
  paths.add_path(place_of(setup.places, "control"), setup.control.value_or(""));
}

}  // namespace

const PortSetup* LineSetup::serial() const {
  const auto found = std::find_if(ports.begin(), ports.end(),
                                  [](const PortSetup& port) { return port.kind == Kind::Serial; });
  return found == ports.end() ? nullptr : &*found;
}

void complete(Setup& setup) {
  add_defaults(setup);
  check_speed(setup);
  for (const LineSetup& line : setup.lines) {
    check_ports(line, setup.speed);
    if (line.instant && line.strict_gaps) {
      fail(place_of(line.places, "strict-gaps") +
           "cannot be combined with timing instant, because that line has no gaps to check; "
           "leave out one of them");
    }
  }
  check_uses(setup);
}

}  // namespace ex9000::sim
