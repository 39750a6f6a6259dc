// Plays files against modules in virtual time and reports the results.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sim/app/play/play_observer.hpp"
#include "sim/app/setup/setup.hpp"

namespace ex9000::play {

/// `path`: a transcript, a scenario, or a folder of one kind. A scenario requires `bus`; transcripts, none.
struct Task {
  std::string path;
  std::optional<sim::Setup> bus;
  sim::Writing writing;
};

/// Prints a line for each run and a summary; returns whether all runs have passed. Throws
/// std::invalid_argument, before any call of `observer`, if a file is wrong or does not fit `bus` (see Task);
/// if `bus` lacks what a scenario uses, has a fault of a module that its line lacks, or an EEPROM file that
/// is not a readable image; or if the capture is a file that is played or that `bus` names.
bool play(const Task& task, const std::function<void(const std::string& line)>& print,
          PlayObserver& observer);

}  // namespace ex9000::play
