// Starts one ex9000-sim in stepped time, with one line for each transcript.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/app/play/transcript.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/process_target.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::system {

/// One process serves all transcripts, because the start of a process takes longer than most transcripts. All
/// lines of the process share one line time, so a test must play the transcripts one after another.
class TranscriptLines {
 public:
  enum class Over { PseudoTerminal, Tcp };

  /// Each line has one module, with the model and the settings of the transcript at the same position. The
  /// constructor switches the supplies of all modules off. With TCP, the program is that of
  /// `shipped_simulator_path`. With pseudo-terminals, it is that of `simulator_path`, which can have
  /// sanitizers.
  TranscriptLines(const std::vector<const play::Transcript*>& transcripts, Over over);

  /// Returns the module for the transcript at `position`.
  ProcessTarget target(std::size_t position);

 private:
  Directory directory_;
  Over over_;
  SimulatorProcess simulator_;
  ControlClient control_;
};

}  // namespace ex9000::system
