// Files that a capture must not overwrite.
#pragma once

#include <string>
#include <vector>

#include "sim/setup/setup.hpp"

namespace ex9000::sim {

/// A file that is read or opened in addition to the capture.
struct InUse {
  std::string what;  ///< a description for people
  std::string path;
};

/// Returns all files that a run or a play of `setup` uses in addition to its capture.
std::vector<InUse> in_use_by(const Setup& setup);

/// Throws std::invalid_argument with a one-line message if `capture` is one of `others`, even under another
/// name. Opens and changes nothing.
void refuse_overwriting(const std::string& capture, const std::vector<InUse>& others);

}  // namespace ex9000::sim
