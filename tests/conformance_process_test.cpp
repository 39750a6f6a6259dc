// All transcripts against the running simulator, over its pseudo-terminal and its control socket.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "sim/play/player.hpp"
#include "sim/play/transcript.hpp"
#include "tests/runner/core_target.hpp"
#include "tests/system/process_target.hpp"

namespace ex9000 {
namespace {

/// They wait nearly all the time: a paced line takes as long as a real one.
constexpr unsigned kAtOnce = 40;

struct Played {
  play::Transcript transcript;
  play::Result result;
};

/// Those that take longest first, so that no few are left waiting for at the end.
std::vector<Played> all_runs() {
  std::vector<Played> runs;
  for (const std::string& file : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    for (play::Transcript& transcript : play::load_transcripts(file)) {
      runs.push_back({std::move(transcript), {}});
    }
  }
  std::stable_sort(runs.begin(), runs.end(), [](const Played& a, const Played& b) {
    return a.transcript.waits() > b.transcript.waits();
  });
  return runs;
}

void play_on_a_simulator(Played& run) {
  try {
    system::ProcessTarget target;
    run.result = play::play(run.transcript, target);
  } catch (const std::exception& error) {
    run.result.failure = run.transcript.file + ": " + error.what();
  }
}

TEST(Conformance, TheSimulatorPassesEveryTranscriptOnEveryModelItNames) {
  std::vector<Played> runs = all_runs();
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> players;
  for (unsigned i = 0; i < kAtOnce; ++i) {
    players.emplace_back([&] {
      for (std::size_t mine = next++; mine < runs.size(); mine = next++) {
        play_on_a_simulator(runs[mine]);
      }
    });
  }
  for (std::thread& player : players) {
    player.join();
  }
  // On a machine that is busy with other things a wait may last longer than the transcript says, and a
  // watchdog be over before it is looked at. Alone, a transcript gets all the time there is.
  std::size_t again = 0;
  for (Played& run : runs) {
    if (!run.result.passed()) {
      std::printf("alone once more: %s\n", run.result.failure.c_str());
      ++again;
      play_on_a_simulator(run);
    }
  }
  std::size_t steps = 0;
  std::size_t core_steps = 0;
  for (const Played& run : runs) {
    EXPECT_TRUE(run.result.passed()) << run.result.failure;
    steps += run.result.steps;
    runner::CoreTarget core;
    core_steps += play::play(run.transcript, core).steps;
  }
  EXPECT_EQ(steps, core_steps);
  std::printf("process: %zu runs, %zu steps, as the core; %zu of them alone once more\n", runs.size(), steps,
              again);
}

}  // namespace
}  // namespace ex9000
