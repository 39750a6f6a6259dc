// Plays files against modules in virtual time and reports the results.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sim/app/play/play_observer.hpp"
#include "sim/app/setup/setup.hpp"

namespace ex9000::play {

/// The files to play, the bus, and the records to write. `path` is a transcript, a scenario, or a directory
/// of transcripts or of scenarios. A scenario requires `bus`. A transcript names its models and excludes
/// `bus`.
struct Task {
  std::string path;
  std::optional<sim::Setup> bus;
  sim::Writing writing;
};

/// Plays the files. Prints one line of text for each run, and then a summary. Returns whether all runs have
/// passed. In the following cases, throws std::invalid_argument with a one-line message, and does not call
/// `observer`:
/// - The path or the content of a file is wrong.
/// - A file is a scenario, but `task` has no `bus`, or `bus` lacks something that the scenario uses.
/// - A file is a transcript, but `task` has a `bus`.
/// - A fault of `bus` names a module that its line does not have.
/// - An EEPROM file of `bus` is not an EEPROM image, or is not readable.
/// - The capture is a file that is played or that `bus` names.
bool play(const Task& task, const std::function<void(const std::string& line)>& print,
          PlayObserver& observer);

}  // namespace ex9000::play
