// Plays files against modules in virtual time, and reports.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "sim/play/onlooker.hpp"
#include "sim/setup.hpp"

namespace ex9000::play {

/// What is to be played: a transcript, which names its models, a directory of them, or a scenario on `bus`.
struct Task {
  std::string path;
  std::optional<sim::Setup> bus;
  sim::Writing writing;
};

/// Prints a line for each run, and one for all. Whether all have passed. Throws std::invalid_argument, one
/// line, where the path or what stands there is wrong, the bus is missing, lacks something or is of no use,
/// or the capture is one of the files that are read: `onlooker` has been told nothing then.
bool play(const Task& task, const std::function<void(const std::string& line)>& print, Onlooker& onlooker);

}  // namespace ex9000::play
