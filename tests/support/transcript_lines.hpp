// A running ex9000-sim in stepped time, with a line for each of several transcripts.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/play/transcript.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/process_target.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::system {

/// One process, because starting one for each takes longer than what most of them say. Its lines share their
/// time, so transcripts are played one after the other.
class TranscriptLines {
 public:
  enum class Over { PseudoTerminal, Tcp };

  /// Each line has the module that the transcript at its position begins with, without power. Over TCP this
  /// is the program as it is shipped; over the pseudo-terminal, with sanitizers.
  TranscriptLines(const std::vector<const play::Transcript*>& transcripts, Over over);

  /// That module.
  ProcessTarget target(std::size_t position);

 private:
  Directory directory_;
  Over over_;
  SimulatorProcess simulator_;
  ControlClient control_;
};

}  // namespace ex9000::system
