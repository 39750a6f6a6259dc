// Files that a capture must not overwrite.
#pragma once

#include <string>
#include <vector>

#include "sim/app/run_setup/setup.hpp"

namespace ex9000::sim {

/// A file, socket or device, other than the capture, that the program uses.
struct InUse {
  std::string what;  ///< what the file is, for an error message
  std::string path;
};

/// Returns all files that a run or a play of `setup` uses in addition to its capture.
std::vector<InUse> in_use_by(const Setup& setup);

/// Throws std::invalid_argument with a one-line message if `capture` is one of `others`, even under another
/// name. Does not open or change any file.
void refuse_overwriting(const std::string& capture, const std::vector<InUse>& others);

}  // namespace ex9000::sim
