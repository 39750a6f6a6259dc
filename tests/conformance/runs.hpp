// Plays transcripts in parallel, and checks that they pass.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "sim/app/play/player.hpp"
#include "sim/app/play/transcript.hpp"
#include "tests/support/transcripts.hpp"

namespace ex9000::conformance {

/// A transcript and its result.
struct Played {
  play::Transcript transcript;
  play::Result result;
};

/// Returns all runs of all files. The runs have not been played yet.
inline std::vector<Played> all_runs() {
  std::vector<Played> runs;
  for (const std::string& file : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    for (play::Transcript& transcript : runner::load_transcripts(file)) {
      runs.push_back({std::move(transcript), {}});
    }
  }
  return runs;
}

inline constexpr std::array<std::string_view, 8> kModelsOfTheManuals{
    "EX9042D", "EX9042D-M", "EX9043D", "EX9043D-M", "EX9052D", "EX9052D-M", "EX9068D-M", "EX9068AD-M"};

/// Returns the runs of `all_runs` for the models in the manuals.
inline std::vector<Played> runs_of_the_manuals() {
  std::vector<Played> runs = all_runs();
  const auto others = std::remove_if(runs.begin(), runs.end(), [](const Played& run) {
    return std::count(kModelsOfTheManuals.begin(), kModelsOfTheManuals.end(),
                      run.transcript.model->designation) == 0;
  });
  runs.erase(others, runs.end());
  return runs;
}

/// Sorts the longest runs to the front, so that the test does not wait for a few long runs at the end.
/// `duration_of` returns the approximate duration of a transcript.
template <class DurationOf>
void put_longest_first(std::vector<Played>& runs, DurationOf duration_of) {
  std::stable_sort(runs.begin(), runs.end(), [&](const Played& a, const Played& b) {
    return duration_of(a.transcript) > duration_of(b.transcript);
  });
}

/// Plays a run. An exception of the target becomes the failure of the run.
inline void play_run(Played& run, play::Target& target) {
  try {
    run.result = play::play(run.transcript, target);
  } catch (const std::exception& error) {
    run.result.failure = run.transcript.file + ": " + error.what() + " (" + run.transcript.run + ")";
  }
}

/// Calls `player` with the numbers 0 to `count` - 1, each in its own thread, and waits until all calls
/// have returned.
template <class Player>
void in_parallel(unsigned count, Player player) {
  std::vector<std::thread> players;
  for (unsigned number = 0; number < count; ++number) {
    players.emplace_back([&player, number] { player(number); });
  }
  for (std::thread& each : players) {
    each.join();
  }
}

inline unsigned processors() { return std::max(1U, std::thread::hardware_concurrency()); }

/// Returns the number of steps in a file: its lines, except blank lines, comments and the header. Does not
/// use the reader of transcripts.
inline std::size_t steps_in(const std::string& path) {
  std::ifstream file(path);
  std::size_t steps = 0;
  for (std::string line; std::getline(file, line);) {
    const auto begins = [&line](const char* with) { return line.rfind(with, 0) == 0; };
    const bool header = begins("source:") || begins("model:") || begins("models:") || begins("with:") ||
                        begins("preset:") || begins("tags:");
    steps += line.empty() || begins(";") || header ? 0U : 1U;
  }
  return steps;
}

/// Expects that all runs have passed, and that each has played all steps of its file.
inline void expect_all_steps_passed(const char* name, const std::vector<Played>& runs) {
  EXPECT_FALSE(runs.empty());
  std::size_t steps = 0;
  for (const Played& run : runs) {
    EXPECT_TRUE(run.result.passed()) << run.result.failure;
    EXPECT_EQ(run.result.steps, steps_in(run.transcript.file)) << run.transcript.file;
    steps += run.result.steps;
  }
  std::printf("%s: %zu runs, %zu steps\n", name, runs.size(), steps);
}

}  // namespace ex9000::conformance
