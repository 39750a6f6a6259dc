// The greeting that the program prints first.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/serial_mode.hpp"

namespace ex9000::sim {

/// A module after it has started up.
struct ModuleSummary {
  std::string designation;
  unsigned inputs = 0;
  unsigned outputs = 0;
  std::uint8_t address = 0;
  bool speaks_ascii = false;
  hal::SerialMode mode;
  std::string remark;  ///< about its settings; empty: none
};

struct LineSummary {
  std::string name;  ///< empty for the line of a command line
  hal::SerialMode mode;
  bool instant = false;
  std::vector<ModuleSummary> modules;
  std::string pty;         ///< link of the pseudo-terminal; empty: none
  std::string pty_device;  ///< the device to which the link points
  std::string tcp;         ///< HOST:PORT of the TCP port; empty: none
  std::string modbus_tcp;  ///< HOST:PORT of the gateway; empty: none
  std::string serial;      ///< the serial port; empty: none
};

struct BannerContent {
  std::vector<LineSummary> lines;
  std::string panel;    ///< URL for a browser; empty: none
  std::string control;  ///< path of the control socket; empty: none
};

/// Returns a text of several lines that names the simulated lines, their ports and their modules. For each
/// module that masters can reach through a pseudo-terminal or a gateway, the text contains commands that the
/// user can paste. These commands read a Modbus module and switch an output. For a module that speaks ASCII,
/// the command opens a terminal.
std::string greeting(const BannerContent& all);

}  // namespace ex9000::sim
