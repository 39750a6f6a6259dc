// Selects transcripts, plays them in parallel, and checks that they pass. If EX9000_PLAY is set in the
// environment, only the runs that it selects take part: those of a folder (dcon/init), of a file
// (dcon/init/baud-change.txt), or one that a failed test has named.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "sim/app/play/player.hpp"
#include "sim/app/play/transcript.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/words.hpp"
#include "tests/support/transcripts.hpp"

namespace ex9000::conformance {

/// A transcript and its result.
struct Played {
  play::Transcript transcript;
  play::Result result;
};

/// Returns the path of the file below the folder of this header.
inline std::string path_of(const std::string& file) {
  return file.substr(std::string_view(EX9000_CONFORMANCE_DIR "/").size());
}

/// Returns the name of a run for EX9000_PLAY: the path of the file and what the run has in addition.
inline std::string name_of(const Played& run) {
  return path_of(run.transcript.file) + " " + run.transcript.run;
}

/// Returns the value of EX9000_PLAY. Empty: all runs take part.
inline std::string selection() {
  const char* const wanted = std::getenv("EX9000_PLAY");
  return wanted == nullptr ? "" : wanted;
}

/// Returns whether the name or path `whole` is `begin` or continues it with another part.
inline bool continues(const std::string& whole, const std::string& begin) {
  return begin.empty() || whole == begin || whole.rfind(begin + "/", 0) == 0 ||
         whole.rfind(begin + " ", 0) == 0;
}

/// How a target can be updated, which decides about three folders with transcripts.
enum class Updates {
  Simulated,  ///< any image can be activated
  Images,     ///< as Simulated, but an image that is activated must be one
  None,       ///< the board has no image slots
};

/// `path`: of a transcript, below the folder of this header.
inline bool can_play(Updates updates, const std::string& path) {
  return updates == Updates::None
             ? !continues(path, "modbus/update") && !continues(path, "modbus/update-simulated")
             : !continues(path, "modbus/no-update") &&
                   (updates == Updates::Simulated || !continues(path, "modbus/update-simulated"));
}

/// Returns the runs of all files for targets like these, or those that EX9000_PLAY selects. The runs have not
/// been played yet. Throws std::invalid_argument if EX9000_PLAY selects none.
inline std::vector<Played> all_runs(Updates updates) {
  const std::string wanted = selection();
  std::vector<Played> runs;
  for (const std::string& file : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    if (!can_play(updates, path_of(file)) ||
        (!continues(path_of(file), wanted) && !continues(wanted, path_of(file)))) {
      continue;
    }
    for (play::Transcript& transcript : runner::load_transcripts(file)) {
      Played run{std::move(transcript), {}};
      if (name_of(run) == wanted) {
        return {run};
      }
      if (continues(name_of(run), wanted)) {
        runs.push_back(std::move(run));
      }
    }
  }
  if (runs.empty()) {
    sim::fail("EX9000_PLAY=" + sim::shell_word(wanted) + " selects no run; name a folder, a file or a run");
  }
  return runs;
}

inline constexpr std::array<std::string_view, 8> kModelsOfTheManuals{
    "EX9042D", "EX9042D-M", "EX9043D", "EX9043D-M", "EX9052D", "EX9052D-M", "EX9068D-M", "EX9068AD-M"};

/// Returns the runs of `all_runs` for the models in the manuals.
inline std::vector<Played> runs_of_the_manuals(Updates updates) {
  std::vector<Played> runs = all_runs(updates);
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

/// Returns what has failed in a run, and the command that repeats only this run.
inline std::string failure_of(const Played& run) {
  return run.result.failure + "\nto repeat it: EX9000_PLAY=" + sim::shell_word(name_of(run)) + " " +
         std::filesystem::read_symlink("/proc/self/exe").string();
}

/// Expects that all runs have passed, and that each has played all steps of its file.
inline void expect_all_steps_passed(const char* name, const std::vector<Played>& runs) {
  EXPECT_FALSE(runs.empty() && selection().empty());
  std::size_t steps = 0;
  for (const Played& run : runs) {
    if (!run.result.passed()) {
      ADD_FAILURE() << failure_of(run);
    } else {
      EXPECT_EQ(run.result.steps, steps_in(run.transcript.file)) << run.transcript.file;
    }
    steps += run.result.steps;
  }
  std::printf("%s: %zu runs, %zu steps\n", name, runs.size(), steps);
}

}  // namespace ex9000::conformance
