// Plays all transcripts on the core in virtual time. Checks that transcripts with long waits are marked slow.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "sim/app/play/player.hpp"
#include "sim/app/play/transcript.hpp"
#include "tests/support/core_target.hpp"
#include "tests/support/coverage.hpp"
#include "tests/support/transcripts.hpp"

namespace ex9000 {
namespace {

TEST(Conformance, TheCorePassesAllTranscriptsAndTheyReachAllModelsTableRowsRefusalsAndVerdicts) {
  const std::vector<std::string> files = play::transcript_files(EX9000_CONFORMANCE_DIR);
  ASSERT_FALSE(files.empty());
  std::size_t runs = 0;
  std::size_t steps = 0;
  std::set<std::string_view> models;
  runner::Coverage coverage;
  for (const std::string& file : files) {
    for (const play::Transcript& transcript : runner::load_transcripts(file)) {
      runner::CoreTarget target(&coverage);
      const play::Result result = play::play(transcript, target);
      EXPECT_TRUE(result.passed()) << result.failure;
      ++runs;
      steps += result.steps;
      models.insert(transcript.model->designation);
    }
  }
  for (const Model& model : kModels) {
    EXPECT_EQ(models.count(model.designation), 1U) << model.designation << " has no transcript";
  }
  for (const std::string& id : coverage.missing()) {
    ADD_FAILURE() << id << " is not reached by any transcript";
  }
  std::printf("core: %zu files, %zu runs, %zu steps, %zu rows, refusals and verdicts reached\n", files.size(),
              runs, steps, coverage.reached());
}

TEST(Conformance, TheTotalWaitOfATranscriptIsUnderTwoSecondsUnlessItsFileIsMarkedSlow) {
  for (const std::string& file : play::transcript_files(EX9000_CONFORMANCE_DIR)) {
    for (const play::Transcript& transcript : runner::load_transcripts(file)) {
      EXPECT_TRUE(transcript.slow || runner::waits_of(transcript) < std::chrono::seconds(2)) << file;
    }
  }
}

}  // namespace
}  // namespace ex9000
