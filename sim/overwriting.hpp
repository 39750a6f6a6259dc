// What a capture must not be written over.
#pragma once

#include <string>
#include <vector>

#include "sim/setup.hpp"

namespace ex9000::sim {

/// Something that is read, or opened, beside the capture.
struct InUse {
  std::string what;  ///< for people
  std::string path;
};

/// All that a run, or a play, of `setup` has beside its capture.
std::vector<InUse> in_use_by(const Setup& setup);

/// Throws std::invalid_argument, one line, where `capture` is one of `others`, be it by another name. Opens
/// and changes nothing.
void refuse_overwriting(const std::string& capture, const std::vector<InUse>& others);

}  // namespace ex9000::sim
