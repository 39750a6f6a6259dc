// Files that a capture must not overwrite.
#pragma once

#include <string>
#include <vector>

#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

/// A file, socket or device, other than the capture.
struct InUse {
  std::string what;  ///< what the file is, for an error message
  std::string path;
};

/// The bus file, the control socket, the links to pseudo-terminals, the serial ports, the EEPROM files.
std::vector<InUse> in_use_by(const Setup& setup);

/// Throws if `capture` is one of `others`, even under another name. Does not open or change any file.
void refuse_overwriting(const std::string& capture, const std::vector<InUse>& others);

}  // namespace ex9000::sim
