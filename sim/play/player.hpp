// Plays transcripts.
#pragma once

#include <cstddef>
#include <string>

#include "sim/play/target.hpp"
#include "sim/play/transcript.hpp"

namespace ex9000::play {

struct Result {
  std::size_t steps = 0;  ///< played, the failed one included
  std::string failure;    ///< file, line, what was expected and what came; empty: passed

  [[nodiscard]] bool passed() const { return failure.empty(); }
};

/// Plays all steps, up to the first that fails. A scenario's target has been started.
Result play(const Transcript& transcript, Target& target);

}  // namespace ex9000::play
