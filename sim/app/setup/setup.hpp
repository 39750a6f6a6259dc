// The configuration of a run, from a command line, from a bus file, or from both.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/line_format.hpp"

#include "sim/app/setup/port_setup.hpp"
#include "sim/notation/setting.hpp"
#include "sim/virtual_line/line/module_spec.hpp"

namespace ex9000::sim {

struct LineSetup {
  std::string name;                 ///< may be empty if there is only one line
  std::vector<ModuleSpec> modules;  ///< at least one
  std::vector<PortSetup> ports;
  /// The baud rate of the line at the start; nullopt: the baud rate of the first module.
  std::optional<std::uint32_t> baud;
  /// The format of the line at the start; nullopt: the format of the first module.
  std::optional<LineFormat> format;
  bool instant = false;  ///< bytes take almost no time
  bool strict_gaps = false;
  std::vector<Fault> faults;  ///< of the line, or of all its modules
  Places places;

  /// The line's serial port, which excludes all other ports; null if it has none.
  [[nodiscard]] const PortSetup* serial() const;
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
  Speed speed;
  /// How long the modules are up, in the lines' time, before the run ends; nullopt: the run has no planned
  /// end.
  std::optional<VirtualTime> lasts;
  std::uint64_t seed = 1;  ///< seed of all random events: noise, faults with a probability, bouncing contacts
  Places places;
};

/// The settings of a run and of a line. The command line has all of them as options; a bus file has those of
/// a line in each object of `lines`.
extern const std::vector<Setting<Setup>> run_settings;
extern const std::vector<Setting<LineSetup>> line_settings;

/// Gives a line without ports a pseudo-terminal, and the lines of a bus file names; then checks values
/// against each other. Throws std::invalid_argument with a one-line message if they cannot be combined, if a
/// value that another value requires is missing, or if a path, an address or a name has two uses.
void complete(Setup& setup);

}  // namespace ex9000::sim
