// The greeting that the program prints when it starts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/serial_mode.hpp"

#include "sim/files_and_ports/ports/port.hpp"

namespace ex9000::sim {

/// A module after it has started up.
struct ModuleSummary {
  std::string designation;
  unsigned inputs = 0;
  unsigned outputs = 0;
  std::uint8_t address = 0;
  bool speaks_ascii = false;
  hal::SerialMode mode;
  std::string remark;  ///< about the module's settings; empty: none
};

struct LineSummary {
  std::string name;  ///< empty if the command line describes the line
  hal::SerialMode mode;
  bool instant = false;
  std::vector<ModuleSummary> modules;
  std::vector<PortSummary> ports;

  /// The first port of this kind; null if the line has none.
  [[nodiscard]] const PortSummary* port(const std::string& kind) const;
};

struct BannerContent {
  std::vector<LineSummary> lines;
  std::string panel;    ///< URL for a browser; empty: none
  std::string control;  ///< path of the control socket; empty: none
};

/// Returns a text of several lines that names the version, the panel, the simulated lines with their ports
/// and modules, and the control socket. For each module that masters can reach through a pseudo-terminal or a
/// gateway, the text contains commands that the user can paste. For a Modbus module, these commands read the
/// outputs, the inputs and the counters that the module has, and switch output 0 on if there are outputs. For
/// a module that speaks ASCII, the command opens a terminal program.
std::string greeting(const BannerContent& all);

}  // namespace ex9000::sim
