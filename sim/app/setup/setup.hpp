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
  /// At the start; nullopt: those of the first module.
  std::optional<std::uint32_t> baud;
  std::optional<LineFormat> format;
  bool instant = false;  ///< bytes take almost no time
  bool strict_gaps = false;
  std::vector<Fault> faults;  ///< of the line, or of all its modules
  Places places;

  /// It excludes all other ports; null: none.
  [[nodiscard]] const PortSetup* serial() const;
};

struct PanelSetup {
  /// 0: any free port; nullopt: the default port, or any free port if that is in use.
  std::optional<std::uint16_t> port;
};

enum class LogFormat { Text, Json };

/// The records that a run writes.
struct Writing {
  std::optional<LogFormat> log;        ///< nullopt: frames are not logged
  std::optional<std::string> capture;  ///< path of the capture file; nullopt: no capture
};

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
  /// How long the modules are up, in the lines' time; nullopt: the run has no planned end.
  std::optional<VirtualTime> lasts;
  std::uint64_t seed = 1;  ///< seed of all random events: noise, faults with a probability, bouncing contacts
  Places places;
};

/// Options of the command line. A bus file has those of a line in each object of `lines`.
extern const std::vector<Setting<Setup>> run_settings;
extern const std::vector<Setting<LineSetup>> line_settings;

/// Gives a line without ports a pseudo-terminal, and the lines of a bus file names. Throws if values exclude
/// each other, one that another requires is missing, or a path, address or name has two uses.
void complete(Setup& setup);

}  // namespace ex9000::sim
