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

/// Plays the files. Prints one line of text for each run and a summary. Returns whether all runs have passed.
/// Throws std::invalid_argument with a one-line message if the path or the content of a file is wrong, if the
/// bus is missing, lacks something that a scenario uses, or is not used, if a fault of `bus` names a module
/// that its line does not have, if an EEPROM file of `bus` is not an image or is not readable, or if the
/// capture is a file that is played or that `bus` names. In these cases `observer` is not called.
bool play(const Task& task, const std::function<void(const std::string& line)>& print,
          PlayObserver& observer);

}  // namespace ex9000::play
