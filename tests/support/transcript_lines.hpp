// A running ex9000-sim with a line for each of several transcripts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/play/transcript.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/process_target.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::system {

/// One process, as starting one for each takes longer than what most of them say.
class TranscriptLines {
 public:
  /// On each line the module that the transcript at its position begins with.
  explicit TranscriptLines(const std::vector<const play::Transcript*>& transcripts);

  /// That module.
  [[nodiscard]] ProcessTarget target(std::size_t position) const;

 private:
  Directory directory_;
  SimulatorProcess simulator_;
};

}  // namespace ex9000::system
