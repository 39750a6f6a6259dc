#include "sim/setup.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <utility>

#include "firmware/model/baud.hpp"

namespace ex9000::sim {

namespace {

void check(const LineSetup& line, std::size_t position) {
  const auto wrong = [position](const std::string& key, const std::string& what) {
    throw WrongSetup(position, key, what);
  };
  for (const auto& [key, path] : {std::pair("pty", line.pty), std::pair("serial", line.serial)}) {
    if (path && path->empty()) {
      wrong(key, "wants a path");
    }
  }
  const auto is_of_a_word = [](unsigned char character) { return std::isgraph(character) != 0; };
  if (!std::all_of(line.name.begin(), line.name.end(), is_of_a_word)) {
    wrong("name",
          "'" + line.name + "' is not one word of ASCII, which 'line NAME' of the control socket wants");
  }
  if (line.serial && (line.pty || line.tcp)) {
    wrong("serial", "the master is on that line; leave out pty and tcp");
  }
  if (line.echo && !line.serial) {
    wrong("echo", "only a serial port may have one; serial names it");
  }
  if (line.instant && line.serial) {
    wrong("line", "instant: on a real line bytes take their time; leave it out with serial");
  }
  if (line.instant && line.strict_gaps) {
    wrong("strict-gaps", "gaps mean nothing on an instant line; leave one of them out");
  }
}

/// Of paths and names that must not be given twice.
class Once {
 public:
  explicit Once(std::string mend) : mend_(std::move(mend)) {}

  void add(std::size_t line, const std::string& key, const std::optional<std::string>& name,
           std::optional<std::size_t> module = std::nullopt) {
    if (name && !name->empty() && !seen_.insert(*name).second) {
      throw WrongSetup(line, key, *name + mend_, module);
    }
  }

 private:
  std::string mend_;
  std::set<std::string> seen_;
};

/// What is real keeps the wall clock's time.
void check_speed(const Setup& setup) {
  const auto wrong = [](const std::string& what) { throw WrongSetup(std::nullopt, "speed", what); };
  for (const LineSetup& line : setup.lines) {
    if (line.serial && !(setup.speed.paced() && setup.speed.factor == 1)) {
      wrong("a real line has its own time; leave it out with serial");
    }
    if (setup.speed.max() && (line.pty || line.tcp)) {
      wrong("max: masters keep the wall clock's time; leave out pty and tcp, or give a number");
    }
  }
  if (setup.speed.stepped() && !setup.control) {
    wrong("step: only the control socket moves the time; name one with 'control'");
  }
  if (setup.speed.stepped() && setup.panel) {
    wrong("step: the panel shows time that passes by itself; leave it out, as panel off does");
  }
  if (setup.speed.max() && setup.control) {
    wrong("max: there is no time to listen to the control socket; leave it out, or give a number");
  }
  if (setup.speed.max() && setup.panel) {
    wrong("max: there is no time to look at the panel; leave it out, as panel off does, or give a number");
  }
  if (setup.speed.max() && !setup.lasts) {
    wrong("max: would never end; say how long it is to last with 'for'");
  }
}

}  // namespace

void check(const Setup& setup) {
  if (setup.watch && setup.log == LogFormat::Json) {
    throw WrongSetup(std::nullopt, "watch",
                     "standard output is for machines, with the log in JSON; leave out one of them");
  }
  check_speed(setup);
  if (setup.control && setup.control->empty()) {
    throw WrongSetup(std::nullopt, "control", "wants a path");
  }
  if (setup.capture && setup.capture->empty()) {
    throw WrongSetup(std::nullopt, "capture", "wants a path");
  }
  Once files(": two modules cannot share one; name a file for each");
  Once ports(": two lines cannot share one; name one for each");
  Once names(": two lines have this name; name each differently");
  for (std::size_t i = 0; i < setup.lines.size(); ++i) {
    const LineSetup& line = setup.lines[i];
    check(line, i);
    for (std::size_t module = 0; module < line.modules.size(); ++module) {
      files.add(i, "eeprom", line.modules[module].eeprom, module);
    }
    ports.add(i, "pty", line.pty);
    ports.add(i, "serial", line.serial);
    if (line.tcp && line.tcp->port != 0) {
      ports.add(i, "tcp", line.tcp->host + ":" + std::to_string(line.tcp->port));
    }
    names.add(i, "name", line.name);
  }
}

std::uint32_t parse_line_rate(const std::string& text) {
  for (const std::uint32_t rate : kBaudRates) {
    if (text == std::to_string(rate)) {
      return rate;
    }
  }
  throw std::invalid_argument("'" + text + "' wants 1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
}

bool parse_line_kind(const std::string& text) {
  if (text != "paced" && text != "instant") {
    throw std::invalid_argument("'" + text + "' wants paced or instant");
  }
  return text == "instant";
}

std::optional<LogFormat> parse_log(const std::string& text) {
  if (text == "off") {
    return std::nullopt;
  }
  if (text != "text" && text != "json") {
    throw std::invalid_argument("'" + text + "' wants text, json or off");
  }
  return text == "json" ? LogFormat::Json : LogFormat::Text;
}

std::uint64_t parse_seed(const std::string& text) {
  std::uint64_t seed = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, seed);
  if (error != std::errc() || rest != end) {
    throw std::invalid_argument("'" + text + "' wants a whole number from 0 on");
  }
  return seed;
}

std::optional<PanelSetup> parse_panel(const std::string& text) {
  if (text == "off") {
    return std::nullopt;
  }
  PanelSetup panel;
  if (!text.empty()) {
    std::uint16_t port = 0;
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, port);
    if (error != std::errc() || rest != end) {
      throw std::invalid_argument("'" + text +
                                  "' wants a port from 0 to 65535, 0 being any that is free, or off");
    }
    panel.port = port;
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
  // Slower would be standing still, and a year of it more than a clock can count; faster than the wall clock
  // wakes anybody it goes in leaps, and max is there.
  constexpr double kSlowest = 0.001;
  constexpr double kFastest = 1000;
  double speed = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, speed);
  if (error != std::errc() || rest != end || !(speed >= kSlowest && speed <= kFastest)) {
    throw std::invalid_argument("'" + text + "' is not a number from 0.001 to 1000, max or step");
  }
  return {Speed::Kind::Paced, speed};
}

}  // namespace ex9000::sim
