// Loads transcripts, and adds up the waiting times in them.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "sim/app/play/transcript.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::runner {

/// Returns the transcripts of a file, one for each model and `with:` line. Throws std::invalid_argument if
/// play::load throws it, or if the file is a scenario.
inline std::vector<play::Transcript> load_transcripts(const std::string& path) {
  std::vector<play::Transcript> transcripts = play::load(path);
  if (transcripts[0].model == nullptr) {
    sim::fail(path + ":1: the file names no model; add a 'model:' line");
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
