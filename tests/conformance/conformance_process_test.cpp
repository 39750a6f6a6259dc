// Plays all transcripts on the running simulator in stepped time, over its pseudo-terminal and over TCP.
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
#include "tests/support/transcripts.hpp"

namespace ex9000 {
namespace {

using Over = system::TranscriptLines::Over;

constexpr std::size_t kLines = 12;  ///< in one simulator process

struct Played {
  play::Transcript transcript;
  play::Result result;
};

std::vector<Played> all_runs() {
  std::vector<Played> runs;
  for (const std::string& file : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    for (play::Transcript& transcript : runner::load_transcripts(file)) {
      runs.push_back({std::move(transcript), {}});
    }
  }
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

/// Plays each transcript on its own line, in one simulator, one after the other.
void play_on_a_simulator(Played* runs, std::size_t count, Over over) try {
  std::vector<const play::Transcript*> transcripts;
  for (std::size_t each = 0; each < count; ++each) {
    transcripts.push_back(&runs[each].transcript);
  }
  system::TranscriptLines lines(transcripts, over);
  for (std::size_t each = 0; each < count; ++each) {
    play_on(lines, each, runs[each]);
  }
} catch (const std::exception& error) {
  std::for_each_n(runs, count, [&error](Played& run) { run.result.failure = error.what(); });
}

class Conformance : public testing::TestWithParam<Over> {};

TEST_P(Conformance, TheSimulatorPassesEveryTranscriptOnEveryModelItNames) {
  std::vector<Played> runs = all_runs();
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> players;
  for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i) {
    players.emplace_back([&] {
      for (std::size_t first = next.fetch_add(kLines); first < runs.size(); first = next.fetch_add(kLines)) {
        play_on_a_simulator(&runs[first], std::min(kLines, runs.size() - first), GetParam());
      }
    });
  }
  for (std::thread& player : players) {
    player.join();
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
  std::printf("process: %zu runs, %zu steps, as the core\n", runs.size(), steps);
}

std::string name_of(const testing::TestParamInfo<Over>& over) {
  return over.param == Over::Tcp ? "OverTcp" : "OverItsPseudoTerminal";
}
INSTANTIATE_TEST_SUITE_P(Ports, Conformance, testing::Values(Over::PseudoTerminal, Over::Tcp), name_of);

}  // namespace
}  // namespace ex9000
