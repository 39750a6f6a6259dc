// The greeting that the program prints when it starts.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/serial_mode.hpp"

#include "sim/files_and_ports/ports/port.hpp"

namespace ex9000::sim {

/// After it has started up.
struct ModuleSummary {
  std::string designation;
  unsigned inputs = 0;
  unsigned outputs = 0;
  std::uint8_t address = 0;
  std::uint32_t serial_number = 0;  ///< by which Modbus reaches it; 0: none
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

  /// The first; null: none.
  [[nodiscard]] const PortSummary* port(const std::string& kind) const;
};

struct BannerContent {
  std::vector<LineSummary> lines;
  std::string panel;    ///< URL for a browser; empty: none
  std::string control;  ///< path of the control socket; empty: none
};

/// Names the version, the panel, the lines with their ports and modules, and the control socket. For each
/// module behind a pseudo-terminal or a gateway, it has commands to paste: they read what a Modbus module has
/// and switch output 0 on, or open a terminal program for ASCII.
std::string greeting(const BannerContent& all);

}  // namespace ex9000::sim
