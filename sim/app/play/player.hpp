// Plays transcripts and scenarios.
#pragma once

#include <cstddef>
#include <string>

#include "sim/app/play/target.hpp"
#include "sim/app/play/transcript.hpp"

namespace ex9000::play {

struct Result {
  std::size_t steps = 0;  ///< steps played, including the failed one
  std::string failure;    ///< where and how the run failed; empty: the run passed

  [[nodiscard]] bool passed() const { return failure.empty(); }
};

/// Plays up to the first failure. If all steps pass, checks that no more bytes arrive, then calls
/// `Target::end`. The modules of a scenario must have started up.
Result play(const Transcript& transcript, Target& target);

}  // namespace ex9000::play
