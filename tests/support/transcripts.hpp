// Loads transcripts, and adds up the waiting times in them. A file with transcripts has at least one `model:`
// line. A scenario has no such line.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "sim/app/play/transcript.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::runner {

/// Returns the transcripts of a file, one for each of its `model:` lines. Throws std::invalid_argument if
/// play::load throws it, or if the file is a scenario.
inline std::vector<play::Transcript> load_transcripts(const std::string& path) {
  std::vector<play::Transcript> transcripts = play::load(path);
  if (transcripts[0].model == nullptr) {
    sim::fail(path + ":1: the file has no 'model:' line; a transcript requires at least one");
  }
  return transcripts;
}

/// Returns the total time of all `wait` and `silence` steps, rounded up to whole milliseconds.
inline std::chrono::milliseconds waits_of(const play::Transcript& transcript) {
  std::chrono::nanoseconds total{0};
  for (const play::Step& step : transcript.steps) {
    const sim::Words words = step.words();
    total += words[0] == "wait"      ? sim::parse_time(words[1])
             : words[0] == "silence" ? play::kSilence
                                     : std::chrono::nanoseconds(0);
  }
  return std::chrono::ceil<std::chrono::milliseconds>(total);
}

}  // namespace ex9000::runner
