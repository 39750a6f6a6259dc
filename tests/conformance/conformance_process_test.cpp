// Plays all transcripts on the running simulator in stepped time, over pseudo-terminals. Plays those about
// framing over TCP too.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <utility>
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

void play_over(Over over, std::vector<Played> runs) {
  std::atomic<std::size_t> next{0};
  in_parallel(processors(), [&](unsigned /*number*/) {
    for (std::size_t first = next.fetch_add(kLines); first < runs.size(); first = next.fetch_add(kLines)) {
      play_on_a_simulator(&runs[first], std::min(kLines, runs.size() - first), over);
    }
  });
  expect_all_steps_passed("process", runs);
}

TEST(Conformance, TheSimulatorPassesEveryTranscriptOverItsPseudoTerminal) {
  play_over(Over::PseudoTerminal, all_runs(Updates::Simulated));
}

TEST(Conformance, TheSimulatorPassesTheTranscriptsAboutFramingOverTcp) {
  std::vector<Played> runs = all_runs(Updates::Simulated);
  const auto others = std::remove_if(runs.begin(), runs.end(), [](const Played& run) {
    return std::filesystem::path(run.transcript.file).parent_path().filename() != "framing";
  });
  runs.erase(others, runs.end());
  play_over(Over::Tcp, std::move(runs));
}

}  // namespace
}  // namespace ex9000::conformance
