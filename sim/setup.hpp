// What a run of the program consists of, be it from a command line or from a bus file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/faults/fault.hpp"
#include "sim/module_spec.hpp"
#include "sim/ports/tcp_address.hpp"

namespace ex9000::sim {

struct LineSetup {
  std::string place;                  ///< where a bus file describes it; empty: the command line does
  std::string name;                   ///< what logs call it; empty where there is but one
  std::vector<ModuleSpec> modules;    ///< at least one
  std::optional<std::string> pty;     ///< where to link a pseudo-terminal
  std::optional<TcpAddress> tcp;      ///< where to listen
  std::optional<std::string> serial;  ///< the port to take; then there is no other
  std::optional<std::uint32_t> baud;  ///< of the line, until a master sets one
  bool echo = false;                  ///< the serial port hears what it sends
  bool instant = false;               ///< bytes cost no time
  bool strict_gaps = false;
  std::vector<Fault> faults;
};

struct PanelSetup {
  std::optional<std::uint16_t> port;  ///< 0: any that is free; nothing: the usual one, or any
};

enum class LogFormat { Text, Json };

/// What is written down.
struct Writing {
  std::optional<LogFormat> log;        ///< of the bus; none: it is not printed
  std::optional<std::string> capture;  ///< where to keep what was on the lines
};

/// What moves the lines' time.
struct Speed {
  enum class Kind {
    Paced,    ///< the wall clock
    Max,      ///< nothing: events follow each other as fast as they can be computed
    Stepped,  ///< the control socket's command `advance`, and nothing else
  };
  Kind kind = Kind::Paced;
  double factor = 1;  ///< Paced: the lines' time to the wall clock's

  [[nodiscard]] bool paced() const { return kind == Kind::Paced; }
  [[nodiscard]] bool max() const { return kind == Kind::Max; }
  [[nodiscard]] bool stepped() const { return kind == Kind::Stepped; }
};

struct Setup : Writing {
  std::string file;                    ///< the bus file that it is from; empty: a command line
  std::vector<LineSetup> lines;        ///< at least one
  std::optional<std::string> control;  ///< where to make the control socket
  std::optional<PanelSetup> panel;     ///< the page for a browser; none: nobody serves it
  bool watch = false;                  ///< the modules are shown on standard output
  Speed speed;
  /// For so long are the modules up, by the lines' time, then it ends; nothing: until it is told to.
  std::optional<VirtualTime> lasts;
  std::uint64_t seed = 1;  ///< of all chance: noise, faults that are probable, contacts that chatter
  /// By key, where that file says so, `bus.json:2: control`; none: it does not.
  std::map<std::string, std::string> places;
};

/// Wrong by the key that it is written under: an option of the command line, or a member of a bus file.
struct WrongSetup : std::invalid_argument {
  WrongSetup(std::optional<std::size_t> its_line, std::string its_key, const std::string& what,
             std::optional<std::size_t> its_module = std::nullopt)
      : std::invalid_argument(what), line(its_line), module(its_module), key(std::move(its_key)) {}

  std::optional<std::size_t> line;    ///< the position of its line; nothing: it is none of a line
  std::optional<std::size_t> module;  ///< on that line; nothing: it is none of a module
  std::string key;
};

/// What each is right of, and all together are not: throws WrongSetup.
void check(const Setup& setup);

// Values that a command line and a bus file write alike. They throw std::invalid_argument, one line.

std::uint32_t parse_line_rate(const std::string& text);
/// Whether bytes cost no time.
bool parse_line_kind(const std::string& text);
std::uint64_t parse_seed(const std::string& text);
/// Nothing: `off`.
std::optional<LogFormat> parse_log(const std::string& text);
/// Empty: at the usual port; nothing: `off`.
std::optional<PanelSetup> parse_panel(const std::string& text);
/// A number from 0.001 to 1000, `max` or `step`.
Speed parse_speed(const std::string& text);

}  // namespace ex9000::sim
