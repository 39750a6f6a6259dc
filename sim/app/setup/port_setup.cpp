#include "sim/app/setup/port_setup.hpp"

#include <set>
#include <string_view>

#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/help_row.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

using Kind = PortSetup::Kind;

void take_path(PortSetup& port, const std::string& where) {
  if (where.empty()) {
    fail("the path is missing");
  }
  port.path = where;
}
void take_address(PortSetup& port, const std::string& where) {
  port.address = parse_listening_address(where);
}

struct KindRow {
  std::string_view name;
  std::string_view where;
  std::string_view does;
  Kind kind;
  void (*take)(PortSetup& port, const std::string& where);

  [[nodiscard]] std::string shape() const { return std::string(name) + ":" + std::string(where); }
};

constexpr KindRow kKinds[] = {
    {"pty", "LINK", "a pseudo-terminal, with a link to it at this path", Kind::Pty, take_path},
    {"tcp", "[HOST:]PORT", "the bytes of the line over TCP: Modbus RTU and DCON", Kind::Tcp, take_address},
    {"modbus-tcp", "[HOST:]PORT", "a Modbus TCP gateway to the modules that speak Modbus", Kind::ModbusTcp,
     take_address},
    {"serial", "DEVICE", "a real line at this serial port", Kind::Serial, take_path},
};

struct OptionRow {
  std::string_view name;
  std::string_view value;  ///< empty: the option has no value
  std::string_view does;
  bool (*fits)(Kind kind);
  void (*take)(PortSetup& port, const std::string& value);

  [[nodiscard]] std::string shape() const {
    return std::string(name) + (value.empty() ? "" : "=" + std::string(value));
  }
};

constexpr OptionRow kOptions[] = {
    {"access", "MODE[:GROUP]", "who may open the pseudo-terminal, for example 660:dialout",
     [](Kind kind) { return kind == Kind::Pty; },
     [](PortSetup& port, const std::string& value) { port.access = parse_pty_access(value); }},
    {"timeout", "TIME",
     "how long the gateway waits for a reply, besides the line's own time (default: 200ms)",
     [](Kind kind) { return kind == Kind::ModbusTcp; },
     [](PortSetup& port, const std::string& value) { port.timeout = parse_time(value); }},
    {"echo", "", "the adapter of the serial port receives what it sends",
     [](Kind kind) { return kind == Kind::Serial; },
     [](PortSetup& port, const std::string& /*value*/) { port.echo = true; }},
    {"wait", "", "line time begins when a master has connected",
     [](Kind kind) { return kind != Kind::Serial; },
     [](PortSetup& port, const std::string& /*value*/) { port.wait = true; }},
};

void take_option(PortSetup& port, const std::string& text) {
  const auto equals = text.find('=');
  const std::string name = text.substr(0, equals);
  for (const OptionRow& row : kOptions) {
    if (row.name == name && row.fits(port.kind)) {
      if (row.value.empty() != (equals == std::string::npos)) {
        fail("expected " + row.shape());
      }
      row.take(port, equals == std::string::npos ? "" : text.substr(equals + 1));
      return;
    }
  }
  Words known;
  for (const OptionRow& row : kOptions) {
    if (row.fits(port.kind)) {
      known.push_back(row.shape());
    }
  }
  fail("unknown option; expected " + joined(known, " or "));
}

}  // namespace

PortSetup parse_port(const std::string& text) {
  const auto colon = text.find(':');
  const std::string name = text.substr(0, colon);
  for (const KindRow& row : kKinds) {
    if (row.name != name || colon == std::string::npos) {
      continue;
    }
    PortSetup port;
    port.kind = row.kind;
    const Words parts = parts_of(text, ',');
    port.text = parts[0];
    with_place(port.text + ": ", [&] { row.take(port, port.text.substr(colon + 1)); });
    std::set<std::string> given;
    for (auto option = parts.begin() + 1; option != parts.end(); ++option) {
      with_place(*option + ": ", [&] {
        if (!given.insert(option->substr(0, option->find('='))).second) {
          fail("is given twice; leave out one of them");
        }
        take_option(port, *option);
      });
    }
    return port;
  }
  Words shapes;
  for (const KindRow& row : kKinds) {
    shapes.push_back(row.shape());
  }
  fail("'" + text + "': expected " + joined(shapes, ", "));
}

std::string port_help() {
  constexpr std::size_t kColumn = 24;
  std::string text;
  for (const KindRow& row : kKinds) {
    text += help_row(row.shape(), row.does, kColumn);
  }
  for (const OptionRow& row : kOptions) {
    text += help_row("," + row.shape(), row.does, kColumn);
  }
  return text;
}

}  // namespace ex9000::sim
