#include "sim/app/setup/setup.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <set>
#include <utility>

#include "sim/files_and_ports/files/one_spelling.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

void reject_empty(std::optional<std::size_t> line, const std::string& key,
                  const std::optional<std::string>& path) {
  if (path && path->empty()) {
    throw SetupError(line, key, "is empty; name a path");
  }
}

void check(const LineSetup& line, std::size_t position) {
  const auto wrong = [position](const std::string& key, const std::string& what,
                                const std::string& value = "") {
    throw SetupError(position, key, what, value);
  };
  reject_empty(position, "pty", line.pty);
  reject_empty(position, "serial", line.serial);
  const auto is_printable = [](unsigned char character) { return std::isgraph(character) != 0; };
  if (!std::all_of(line.name.begin(), line.name.end(), is_printable)) {
    wrong("name", "expected one word of ASCII characters, for 'line NAME' on the control socket",
          "'" + line.name + "'");
  }
  if (line.serial && !line.first_port().empty()) {
    wrong("serial",
          "cannot be combined with {pty}, {tcp} or {modbus-tcp}, because the master is on the serial line; "
          "leave out {serial} or the other ports");
  }
  if (line.echo && !line.serial) {
    wrong("echo", "requires {serial}; add {serial}, or leave out {echo}");
  }
  if (line.pty_access && !line.pty) {
    wrong("pty-access", "requires {pty}; add {pty}, or leave out {pty-access}");
  }
  if (line.modbus_timeout && !line.modbus_tcp) {
    wrong("modbus-timeout", "requires {modbus-tcp}; add {modbus-tcp}, or leave out {modbus-timeout}");
  }
  if (line.instant && line.serial) {
    wrong("line",
          "instant cannot be combined with {serial}, because bytes on a serial line take time; "
          "leave out one of them");
  }
  if (line.instant && line.strict_gaps) {
    wrong("strict-gaps",
          "cannot be combined with {line instant}, because that line has no gaps to check; "
          "leave out one of them");
  }
}

/// Rejects a path, address or name that is given twice.
class Once {
 public:
  /// `identity` returns the same text for all spellings of a name.
  using Identity = std::string (*)(const std::string& name);

  explicit Once(
      std::string problem, Identity identity = [](const std::string& name) { return name; })
      : problem_(std::move(problem)), identity_(identity) {}

  void add(std::optional<std::size_t> line, const std::string& key, const std::optional<std::string>& name,
           std::optional<std::size_t> module = std::nullopt) {
    if (name && !name->empty() && !seen_.insert(identity_(*name)).second) {
      throw SetupError(line, key, problem_, *name, module);
    }
  }

 private:
  std::string problem_;
  Identity identity_;
  std::set<std::string> seen_;
};

/// Rejects a speed that cannot be combined with the ports, the control socket or the panel, or that requires
/// a value that is missing.
void check_speed(const Setup& setup) {
  const auto wrong = [](const std::string& what) { throw SetupError(std::nullopt, "speed", what); };
  for (const LineSetup& line : setup.lines) {
    if (line.serial && !(setup.speed.paced() && setup.speed.factor == 1)) {
      wrong(
          "cannot be combined with {serial}, because a serial line follows the wall clock; "
          "leave out one of them");
    }
    if (setup.speed.max() && !line.first_port().empty()) {
      wrong("max cannot be combined with {" + line.first_port() +
            "}, because masters follow the wall clock; leave out one of them");
    }
  }
  if (setup.speed.stepped() && !setup.control) {
    wrong("step requires {control}, because only the control socket advances the time");
  }
  if (setup.speed.stepped() && setup.panel) {
    wrong(
        "step cannot be combined with {panel}, because the panel shows time that follows the wall clock; "
        "leave out one of them");
  }
  if (setup.speed.max() && setup.control) {
    wrong("max cannot be combined with {control}; leave out one of them");
  }
  if (setup.speed.max() && setup.panel) {
    wrong("max cannot be combined with {panel}; leave out one of them");
  }
  if (setup.speed.max() && !setup.lasts) {
    wrong("max requires --for; add it, for example --for 10s");
  }
}

/// Rejects a path that has two uses.
void check_paths(const Setup& setup) {
  Once paths("is already used for something else; name another path", one_spelling);
  paths.add(std::nullopt, "control", setup.control);
  for (std::size_t i = 0; i < setup.lines.size(); ++i) {
    const LineSetup& line = setup.lines[i];
    paths.add(i, "pty", line.pty);
    paths.add(i, "serial", line.serial);
    for (std::size_t module = 0; module < line.modules.size(); ++module) {
      paths.add(i, "eeprom", line.modules[module].eeprom, module);
    }
  }
}

}  // namespace

std::string place_of(const Places& places, const std::string& key) {
  const auto place = places.find(key);
  return place == places.end() ? "--" + key + " " : place->second + ": ";
}

std::string SetupError::named(const NameOfKey& name_of) const {
  const std::string message = what();
  std::string text = value.empty() ? "" : value + ": ";
  std::size_t at = 0;
  for (auto open = message.find('{'); open != std::string::npos; open = message.find('{', at)) {
    const auto close = message.find('}', open);
    const auto key_ends = std::min(message.find(' ', open), close);
    text += message.substr(at, open - at) + name_of(message.substr(open + 1, key_ends - open - 1),
                                                    message.substr(key_ends, close - key_ends));
    at = close + 1;
  }
  return text + message.substr(at);
}

void check(const Setup& setup) {
  if (setup.watch && setup.log == LogFormat::Json) {
    throw SetupError(
        std::nullopt, "watch",
        "cannot be combined with {log json}, because both write to standard output; leave out one of them");
  }
  check_speed(setup);
  reject_empty(std::nullopt, "control", setup.control);
  reject_empty(std::nullopt, "capture", setup.capture);
  Once files("two modules cannot share a file; name one for each", one_spelling);
  Once ports("two lines cannot share a port; name one for each", one_spelling);
  Once addresses("two ports cannot share an address; name one for each");
  Once names("two lines have this name; give each line a different name");
  for (std::size_t i = 0; i < setup.lines.size(); ++i) {
    const LineSetup& line = setup.lines[i];
    check(line, i);
    for (std::size_t module = 0; module < line.modules.size(); ++module) {
      files.add(i, "eeprom", line.modules[module].eeprom, module);
    }
    ports.add(i, "pty", line.pty);
    ports.add(i, "serial", line.serial);
    for (const auto& [key, address] :
         {std::pair("tcp", line.tcp), std::pair("modbus-tcp", line.modbus_tcp)}) {
      if (address && address->port != 0) {
        addresses.add(i, key, address->host + ":" + std::to_string(address->port));
      }
    }
    names.add(i, "name", line.name);
  }
  check_paths(setup);
}

bool parse_line_kind(const std::string& text) { return parse_choice(text, "instant", "paced"); }

std::optional<LogFormat> parse_log(const std::string& text) {
  if (text == "off") {
    return std::nullopt;
  }
  if (text != "text" && text != "json") {
    fail("'" + text + "': expected text, json or off");
  }
  return text == "json" ? LogFormat::Json : LogFormat::Text;
}

std::uint64_t parse_seed(const std::string& text) {
  return parse_whole_number(text, 0, std::numeric_limits<std::uint64_t>::max());
}

std::size_t parse_threads(const std::string& text) { return parse_whole_number(text, 1, kMostThreads); }

std::optional<PanelSetup> parse_panel(const std::string& text) {
  if (text == "off") {
    return std::nullopt;
  }
  PanelSetup panel;
  if (!text.empty()) {
    const auto port = whole_number(text, std::numeric_limits<std::uint16_t>::max());
    if (!port) {
      fail("'" + text + "': expected a port from 0 to 65535 (0: any free port), or off");
    }
    panel.port = static_cast<std::uint16_t>(*port);
  }
  return panel;
}

Speed parse_speed(const std::string& text) {
  if (text == "max") {
    return {Speed::Kind::Max};
  }
  if (text == "step") {
    return {Speed::Kind::Stepped};
  }
  // Above kFastest, the lines' time would advance in large steps, because the timers of the wall clock are
  // not precise enough. Users can choose `max` instead.
  constexpr double kSlowest = 0.001;
  constexpr double kFastest = 1000;
  const auto speed = decimal_number(text, kSlowest, kFastest);
  if (!speed) {
    fail("'" + text + "': expected a number from 0.001 to 1000, max or step");
  }
  return {Speed::Kind::Paced, *speed};
}

}  // namespace ex9000::sim
