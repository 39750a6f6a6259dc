// The configuration of a run, from a command line, from a bus file, or from both.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/model/line_format.hpp"

#include "sim/files_and_ports/ports/pty_access.hpp"
#include "sim/files_and_ports/ports/tcp_address.hpp"
#include "sim/virtual_line/bus_faults/fault.hpp"
#include "sim/virtual_line/line/module_spec.hpp"

namespace ex9000::sim {

/// The place of each key in the bus file, for example `bus.json:2: control`. Keys from the command line
/// are not included.
using Places = std::map<std::string, std::string>;
/// Returns the prefix of messages about this key: the place in the bus file, or the option of the command
/// line.
std::string place_of(const Places& places, const std::string& key);

struct LineSetup {
  Places places;
  std::string name;                           ///< empty if the command line describes the line
  std::vector<ModuleSpec> modules;            ///< at least one
  std::optional<std::string> pty;             ///< path of the link to a pseudo-terminal
  std::optional<PtyAccess> pty_access;        ///< nullopt: as the system creates it
  std::optional<TcpAddress> tcp;              ///< address on which the TCP port listens
  std::optional<TcpAddress> modbus_tcp;       ///< address on which the Modbus TCP gateway listens
  std::optional<VirtualTime> modbus_timeout;  ///< of the gateway; nullopt: kGatewayTimeout
  std::optional<std::string> serial;          ///< path of the serial port; excludes all other ports
  /// Returns the key of the first port that has a value, in the order pty, tcp, modbus-tcp. Returns an empty
  /// text if none of these ports has a value.
  [[nodiscard]] std::string first_port() const {
    return pty ? "pty" : tcp ? "tcp" : modbus_tcp ? "modbus-tcp" : "";
  }

  /// The baud rate of the line at the start; nullopt: the baud rate of the first module.
  std::optional<std::uint32_t> baud;
  /// The format of the line at the start; nullopt: the format of the first module.
  std::optional<LineFormat> format;
  bool echo = false;     ///< the serial port receives what it sends
  bool instant = false;  ///< bytes take almost no time
  bool strict_gaps = false;
  std::vector<Fault> faults;
};

struct PanelSetup {
  /// 0: any free port; nullopt: the default port, or any free port if the default port is in use.
  std::optional<std::uint16_t> port;
};

enum class LogFormat { Text, Json };

/// The records that a run writes.
struct Writing {
  std::optional<LogFormat> log;        ///< format of the bus log; nullopt: frames are not logged
  std::optional<std::string> capture;  ///< path of the capture file; nullopt: no capture
};

/// How the time of the lines advances.
struct Speed {
  enum class Kind {
    Paced,    ///< with the wall clock
    Max,      ///< as fast as the computer can compute the events
    Stepped,  ///< only with the command `advance` of the control socket
  };
  Kind kind = Kind::Paced;
  double factor = 1;  ///< Paced: the ratio of the lines' time to the wall clock

  [[nodiscard]] bool paced() const { return kind == Kind::Paced; }
  [[nodiscard]] bool max() const { return kind == Kind::Max; }
  [[nodiscard]] bool stepped() const { return kind == Kind::Stepped; }
};

struct Setup : Writing {
  std::string file;                    ///< path of the bus file; empty: there is no bus file
  std::vector<LineSetup> lines;        ///< at least one
  std::optional<std::string> control;  ///< path of the control socket
  std::optional<PanelSetup> panel;     ///< the page for a browser; nullopt: no such page
  bool watch = false;                  ///< show the modules on standard output
  Speed speed;
  /// Highest number of threads for the lines; nullopt: one for each processor, but at most kMostThreads.
  std::optional<std::size_t> threads;
  /// How long the modules are up, in the lines' time, before the run ends; nullopt: the run has no planned
  /// end.
  std::optional<VirtualTime> lasts;
  std::uint64_t seed = 1;  ///< seed of all random events: noise, faults with a probability, bouncing contacts
  Places places;
};

/// An error in a Setup. A key identifies the place: an option of the command line or a member of a bus file.
/// The message can therefore use the syntax of the command line or of the bus file.
struct SetupError : std::invalid_argument {
  /// `what`: the message without its place. Other keys in the message are in braces, with or without a value,
  /// for example `cannot be combined with {serial}` or `cannot be combined with {log json}`.
  SetupError(std::optional<std::size_t> its_line, std::string its_key, const std::string& what,
             std::string its_value = "", std::optional<std::size_t> its_module = std::nullopt)
      : std::invalid_argument(what),
        line(its_line),
        module(its_module),
        key(std::move(its_key)),
        value(std::move(its_value)) {}

  /// Returns how a message refers to `key`. `value` is empty, or a value of the key with a space before it.
  using NameOfKey = std::function<std::string(const std::string& key, const std::string& value)>;
  /// Returns `value` (unless it is empty) and the message, with the result of `name_of` in place of each pair
  /// of braces and its content.
  [[nodiscard]] std::string named(const NameOfKey& name_of) const;

  std::optional<std::size_t> line;  ///< position of the line, from 0; nullopt: not about one line
  /// The position of the module on that line, from 0; nullopt: not about one module.
  std::optional<std::size_t> module;
  std::string key;
  std::string value;  ///< the wrong value; empty if the message does not need it
};

/// Throws SetupError if values cannot be combined, if a value that another value requires is missing, if a
/// path, an address or a name has two uses, or if a path or a name is not valid.
void check(const Setup& setup);

// The functions below parse values of options of the command line. A bus file can contain these values too,
// except the number of threads and the speed. The functions throw std::invalid_argument with a one-line
// message.

/// Parses `instant` or `paced`. Returns true for `instant`: bytes take almost no time.
bool parse_line_kind(const std::string& text);
/// Parses a whole number of up to 64 bits.
std::uint64_t parse_seed(const std::string& text);
/// The highest number of threads. A thread whose lines have pseudo-terminals requires an inotify instance. By
/// default, a user may have 128 inotify instances on Debian.
inline constexpr std::size_t kMostThreads = 64;

/// Parses a number of threads, 1 to kMostThreads.
std::size_t parse_threads(const std::string& text);
/// Parses `text`, `json` or `off`. Returns nullopt for `off`.
std::optional<LogFormat> parse_log(const std::string& text);
/// Parses a port number, `off` or an empty text. Returns a setup without a port for an empty text, and
/// nullopt for `off`.
std::optional<PanelSetup> parse_panel(const std::string& text);
/// Parses a number from 0.001 to 1000, `max` or `step`.
Speed parse_speed(const std::string& text);

}  // namespace ex9000::sim
