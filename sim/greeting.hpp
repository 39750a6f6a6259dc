// What the program says first.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

/// A module as it has come up.
struct ModuleIntroduced {
  std::string designation;
  unsigned inputs = 0;
  unsigned outputs = 0;
  std::uint8_t address = 0;
  bool speaks_ascii = false;
  std::uint32_t baud = 0;
  std::string remark;  ///< on its settings; empty: none
};

struct LineIntroduced {
  std::string name;  ///< empty where there is but one
  std::uint32_t baud = 0;
  bool instant = false;
  std::vector<ModuleIntroduced> modules;
  std::string pty;         ///< link of the pseudo-terminal; empty: there is none
  std::string pty_device;  ///< where it leads
  std::string tcp;         ///< HOST:PORT; likewise
  std::string serial;      ///< the port taken; likewise
};

struct Introduced {
  std::vector<LineIntroduced> lines;
  std::string panel;    ///< where a browser finds it; empty: there is none
  std::string control;  ///< the control socket; likewise
};

/// The lines, their ports, their modules, and commands to paste that poll each of them; several lines of
/// text.
std::string greeting(const Introduced& all);

}  // namespace ex9000::sim
