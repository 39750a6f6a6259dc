#include "sim/app/main/line_options.hpp"

#include <cstddef>
#include <utility>

#include "sim/app/main/option_values.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// Removes the module's position, counted from 1, from the start of `text`, with the blank after it. Returns
/// the position, counted from 0. Returns nullopt and changes nothing if the characters before the first blank
/// are not a number. Throws std::invalid_argument if the number is not from 1 to `modules`.
std::optional<std::size_t> take_position(std::string& text, std::size_t modules) {
  const auto end = text.find(' ');
  if (text.empty() || end == 0 || text.find_first_not_of("0123456789") < end) {
    return std::nullopt;
  }
  const std::string number = text.substr(0, end);
  const std::size_t position = whole_number(number, modules).value_or(0);
  if (position == 0) {
    fail(text + ": no module " + number + "; expected a position from 1 to " + std::to_string(modules));
  }
  text = end == std::string::npos ? "" : text.substr(end + 1);
  return position - 1;
}

Fault parse_fault_of_line(std::string text, std::size_t modules) {
  const std::string whole = text;
  const auto module = take_position(text, modules);
  Fault fault = parse_fault(text);
  if (module && !concerns_a_module(fault.trouble)) {
    fail(whole + ": concerns the line, not a module; leave out the module's position");
  }
  fault.module = module;
  return fault;
}

void add_input(std::string text, std::vector<ModuleSpec>& modules) {
  const std::string whole = text;
  const auto module = take_position(text, modules.size());
  if (!module) {
    fail("'" + whole + "': expected a module's position first, for example '1 0 square 100ms'");
  }
  modules[*module].inputs.push_back(parse_input_program(text, *modules[*module].model));
}

}  // namespace

LineSetup line_of(const LineTexts& texts) {
  LineSetup line;
  for (const std::string& module : texts.modules) {
    line.modules.push_back(parse_module_spec(module));
  }
  for (const std::string& input : texts.inputs) {
    of_option("--input", input, [&](const std::string& text) { add_input(text, line.modules); });
  }
  for (const std::string& fault : texts.faults) {
    line.faults.push_back(of_option("--fault", fault, [&](const std::string& text) {
      return parse_fault_of_line(text, line.modules.size());
    }));
  }
  line.pty = texts.pty;
  line.serial = texts.serial;
  line.echo = texts.echo;
  line.strict_gaps = texts.strict_gaps;
  take_option("--baud", texts.baud, parse_baud_rate, line.baud);
  take_option("--format", texts.format, parse_line_format, line.format);
  take_option("--line", texts.kind, parse_line_kind, line.instant);
  take_option("--pty-access", texts.pty_access, parse_pty_access, line.pty_access);
  take_option("--tcp", texts.tcp, parse_listening_address, line.tcp);
  take_option("--modbus-tcp", texts.modbus_tcp, parse_listening_address, line.modbus_tcp);
  take_option("--modbus-timeout", texts.modbus_timeout, parse_time, line.modbus_timeout);
  return line;
}

void reject_line_options(const std::string& bus_file, const LineTexts& texts) {
  const std::pair<const char*, bool> given[] = {{"--input", !texts.inputs.empty()},
                                                {"--fault", !texts.faults.empty()},
                                                {"--pty", texts.pty.has_value()},
                                                {"--pty-access", texts.pty_access.has_value()},
                                                {"--tcp", texts.tcp.has_value()},
                                                {"--modbus-tcp", texts.modbus_tcp.has_value()},
                                                {"--modbus-timeout", texts.modbus_timeout.has_value()},
                                                {"--serial", texts.serial.has_value()},
                                                {"--baud", texts.baud.has_value()},
                                                {"--line", texts.kind.has_value()},
                                                {"--format", texts.format.has_value()},
                                                {"--echo", texts.echo},
                                                {"--strict-gaps", texts.strict_gaps}};
  for (const auto& [option, is_given] : given) {
    if (is_given) {
      fail(std::string(option) + ": cannot be combined with a bus file; add it to the bus file");
    }
  }
  if (texts.modules.size() != 1) {
    fail(bus_file + ": a bus file has all modules; leave out the other arguments");
  }
}

}  // namespace ex9000::sim
