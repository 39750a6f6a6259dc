// Plays all transcripts on the running simulator in stepped time, over pseudo-terminals and over TCP.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <string>
#include <vector>

#include "tests/conformance/runs.hpp"
#include "tests/support/process_target.hpp"
#include "tests/support/transcript_lines.hpp"

namespace ex9000::conformance {
namespace {

using Over = system::TranscriptLines::Over;

constexpr std::size_t kLines = 12;  ///< in one simulator process; the last process can have fewer

/// Plays the transcripts one after another in one simulator, each on its own line. If the simulator does not
/// start or does not accept a connection, all these transcripts fail.
void play_on_a_simulator(Played* runs, std::size_t count, Over over) try {
  std::vector<const play::Transcript*> transcripts;
  for (std::size_t each = 0; each < count; ++each) {
    transcripts.push_back(&runs[each].transcript);
  }
  system::TranscriptLines lines(transcripts, over);
  for (std::size_t each = 0; each < count; ++each) {
    system::ProcessTarget target = lines.target(each);
    play_run(runs[each], target);
  }
} catch (const std::exception& error) {
  std::for_each_n(runs, count, [&error](Played& run) { run.result.failure = error.what(); });
}

class Conformance : public testing::TestWithParam<Over> {};

TEST_P(Conformance, TheSimulatorPassesEveryTranscriptOnEveryModelThatTheTranscriptNames) {
  std::vector<Played> runs = all_runs();
  std::atomic<std::size_t> next{0};
  in_parallel(processors(), [&](unsigned /*number*/) {
    for (std::size_t first = next.fetch_add(kLines); first < runs.size(); first = next.fetch_add(kLines)) {
      play_on_a_simulator(&runs[first], std::min(kLines, runs.size() - first), GetParam());
    }
  });
  expect_all_steps_passed("process", runs);
}

std::string name_of(const testing::TestParamInfo<Over>& over) {
  return over.param == Over::Tcp ? "OverTcp" : "OverItsPseudoTerminal";
}
INSTANTIATE_TEST_SUITE_P(Ports, Conformance, testing::Values(Over::PseudoTerminal, Over::Tcp), name_of);

}  // namespace
}  // namespace ex9000::conformance
