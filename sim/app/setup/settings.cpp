#include <cctype>
#include <limits>

#include <algorithm>

#include "sim/app/setup/setup.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

std::optional<LogFormat> parse_log(const std::string& text) {
  if (text == "off") {
    return std::nullopt;
  }
  if (text != "json" && text != "text" && text != "on") {
    fail("'" + text + "': expected text, json, on or off");
  }
  return text == "json" ? LogFormat::Json : LogFormat::Text;
}

std::optional<PanelSetup> parse_panel(const std::string& text) {
  if (text == "off") {
    return std::nullopt;
  }
  PanelSetup panel;
  if (text != "on") {
    const auto port = whole_number(text, std::numeric_limits<std::uint16_t>::max());
    if (!port) {
      fail("'" + text + "': expected a port from 0 to 65535 (0: any free port), on or off");
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
  // Above kFastest, the wall clock's timers are too coarse: time would advance in large steps. `max` remains.
  constexpr double kSlowest = 0.001;
  constexpr double kFastest = 1000;
  const auto speed = decimal_number(text, kSlowest, kFastest);
  if (!speed) {
    fail("'" + text + "': expected a number from 0.001 to 1000, max or step");
  }
  return {Speed::Kind::Paced, *speed};
}

std::string parse_path(const std::string& text) {
  if (text.empty()) {
    fail("is empty; name a path");
  }
  return text;
}

std::string parse_line_name(const std::string& text) {
  const auto is_printable = [](unsigned char character) { return std::isgraph(character) != 0; };
  if (text.empty() || !std::all_of(text.begin(), text.end(), is_printable)) {
    fail("'" + text + "': expected one word of ASCII characters, for 'line NAME' on the control socket");
  }
  return text;
}

}  // namespace

const std::vector<Setting<Setup>> run_settings{
    {"log", Form::Optional, "text|json|off", "print each frame and event as a line of text, or as JSON",
     [](Setup& setup, const std::string& value) { setup.log = parse_log(value); }},
    {"capture", Form::Text, "FILE", "write the frames to this pcapng file for Wireshark, which it overwrites",
     [](Setup& setup, const std::string& value) { setup.capture = parse_path(value); }},
    {"panel", Form::Optional, "PORT|off", "serve a page for browsers on this computer (default: 9042)",
     [](Setup& setup, const std::string& value) { setup.panel = parse_panel(value); }},
    {"control", Form::Text, "PATH", "create a UNIX socket for commands; see 'help control'",
     [](Setup& setup, const std::string& value) { setup.control = parse_path(value); }},
    {"speed", Form::Text, "N|max|step", "run N times as fast as the clock; max: at once; step: by 'advance'",
     [](Setup& setup, const std::string& value) { setup.speed = parse_speed(value); }},
    {"for", Form::Text, "TIME", "end when this time has passed on the lines, for example 24h",
     [](Setup& setup, const std::string& value) { setup.lasts = parse_time(value); }},
    {"seed", Form::Text, "NUMBER", "seed random faults and bouncing inputs (default: 1)",
     [](Setup& setup, const std::string& value) {
       setup.seed = parse_whole_number(value, 0, std::numeric_limits<std::uint64_t>::max());
     }},
};

const std::vector<Setting<LineSetup>> line_settings{
    {"port", Form::List, "PORT", "add a port for masters, for example tcp:5020; see 'help ports'",
     [](LineSetup& line, const std::string& value) {
       line.ports.push_back(parse_port(value));
       line.ports.back().place = line.places.at("port");
     }},
    {"baud", Form::Choice, "1200|2400|4800|9600|19200|38400|57600|115200",
     "set the line's baud rate at the start (default: the first module's)",
     [](LineSetup& line, const std::string& value) { line.baud = parse_baud_rate(value); }},
    {"format", Form::Choice, "8N1|8N2|8E1|8O1", "set the line's format (default: the first module's)",
     [](LineSetup& line, const std::string& value) { line.format = parse_line_format(value); }},
    {"timing", Form::Choice, "paced|instant",
     "set how long bytes take: as on a real line (default), or no time",
     [](LineSetup& line, const std::string& value) {
       line.instant = parse_choice(value, "instant", "paced");
     }},
    {"strict-gaps", Form::Flag, "on|off",
     "judge gaps in and between Modbus frames as strictly as a module can",
     [](LineSetup& line, const std::string& value) { line.strict_gaps = parse_on_off(value); }},
    {"fault", Form::List, "FAULT",
     "add a fault of the line, for example 'bit-errors 1e-4'; see 'help faults'",
     [](LineSetup& line, const std::string& value) { line.faults.push_back(parse_fault(value)); }},
    {"name", Form::Text, "NAME", "name the line in logs and commands (default in a bus file: line1, ...)",
     [](LineSetup& line, const std::string& value) { line.name = parse_line_name(value); }},
};

}  // namespace ex9000::sim
