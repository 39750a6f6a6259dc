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
#include "tests/support/core_target.hpp"
#include "tests/support/process_target.hpp"
#include "tests/support/transcript_lines.hpp"

namespace ex9000 {
namespace {

/// They wait nearly all the time: a paced line takes as long as a real one.
constexpr std::size_t kLines = 25;
constexpr unsigned kProcesses = 4;  ///< at a time

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

void play_on(system::TranscriptLines& lines, std::size_t position, Played& run) {
  try {
    system::ProcessTarget target = lines.target(position);
    run.result = play::play(run.transcript, target);
  } catch (const std::exception& error) {
    run.result.failure = run.transcript.file + ": " + error.what();
  }
}

/// Each on a line of its own, in one simulator, all at the same time.
void play_on_a_simulator(Played* runs, std::size_t count) try {
  std::vector<const play::Transcript*> transcripts;
  for (std::size_t each = 0; each < count; ++each) {
    transcripts.push_back(&runs[each].transcript);
  }
  system::TranscriptLines lines(transcripts);
  std::vector<std::thread> players;
  for (std::size_t each = 0; each < count; ++each) {
    players.emplace_back([&lines, each, &run = runs[each]] { play_on(lines, each, run); });
  }
  for (std::thread& player : players) {
    player.join();
  }
} catch (const std::exception& error) {
  std::for_each_n(runs, count, [&error](Played& run) { run.result.failure = error.what(); });
}

TEST(Conformance, TheSimulatorPassesEveryTranscriptOnEveryModelItNames) {
  std::vector<Played> runs = all_runs();
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> processes;
  for (unsigned i = 0; i < kProcesses; ++i) {
    processes.emplace_back([&] {
      for (std::size_t first = next.fetch_add(kLines); first < runs.size(); first = next.fetch_add(kLines)) {
        play_on_a_simulator(&runs[first], std::min(kLines, runs.size() - first));
      }
    });
  }
  for (std::thread& process : processes) {
    process.join();
  }
  // On a machine that is busy with other things a wait may last longer than the transcript says, and a
  // watchdog be over before it is looked at. Alone, a transcript gets all the time there is.
  std::size_t again = 0;
  for (Played& run : runs) {
    if (!run.result.passed()) {
      std::printf("alone once more: %s\n", run.result.failure.c_str());
      ++again;
      play_on_a_simulator(&run, 1);
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
