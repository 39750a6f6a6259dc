// Plays transcripts.
#pragma once

#include <cstddef>
#include <string>

#include "tests/runner/target.hpp"
#include "tests/runner/transcript.hpp"

namespace ex9000::runner {

struct Result {
  std::size_t steps = 0;  ///< played, the failed one included
  std::string failure;    ///< file, line, what was expected and what came; empty: passed

  [[nodiscard]] bool passed() const { return failure.empty(); }
};

/// Plays all steps, up to the first that fails.
Result play(const Transcript& transcript, Target& target);

}  // namespace ex9000::runner
