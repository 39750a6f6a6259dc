// Plays all transcripts on the core in virtual time. Checks that they reach everything that a transcript can
// reach, and that transcripts with long waits are marked slow.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/app/play/model_table.hpp"
#include "tests/conformance/runs.hpp"
#include "tests/support/core_target.hpp"
#include "tests/support/coverage.hpp"

namespace ex9000::conformance {
namespace {

/// The runs are played once, before the tests.
class Conformance : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    runs_ = all_runs(Updates::Simulated);
    for (Played& run : runs_) {
      runner::CoreTarget target(&coverage_);
      play_run(run, target);
    }
  }

  static inline std::vector<Played> runs_;
  static inline runner::Coverage coverage_;
};

TEST_F(Conformance, TheCorePassesTheTranscripts) { expect_all_steps_passed("core", runs_); }

TEST_F(Conformance, TheTranscriptsReachAllModelsTableRowsRefusalsAndVerdicts) {
  if (!selection().empty()) {
    GTEST_SKIP() << "EX9000_PLAY selects some of the transcripts";
  }
  std::set<std::string_view> models;
  for (const Played& run : runs_) {
    models.insert(run.transcript.model->designation);
  }
  for (const Model& model : kModels) {
    EXPECT_EQ(models.count(model.designation), 1U) << model.designation << " has no transcript";
  }
  for (const std::string& id : coverage_.missing()) {
    ADD_FAILURE() << id << " is not reached by any transcript";
  }
  std::printf("core: %zu rows, refusals and verdicts reached\n", coverage_.reached());
}

TEST_F(Conformance, TheTotalWaitOfATranscriptIsUnderTwoSecondsUnlessItsFileIsMarkedSlow) {
  for (const auto& [transcript, result] : runs_) {
    EXPECT_TRUE(transcript.slow || runner::waits_of(transcript) < std::chrono::seconds(2)) << transcript.file;
  }
}

TEST(ModelTable, AssignsToEachModelTheClassesOfItsProtocolAndItsChannels) {
  const play::ModelTable table = play::read_model_table(EX9000_CONFORMANCE_DIR "/models.table");
  EXPECT_EQ(table.size(), std::size(kModels));
  for (const play::ModelEntry& entry : table) {
    const Model& model = *entry.model;
    for (const auto& [name, expected] : {std::pair("ascii", !model.speaks_modbus()),
                                         {"modbus", model.speaks_modbus()},
                                         {"inputs", model.has_inputs()},
                                         {"outputs", model.has_outputs()},
                                         {"wide", model.inputs > 8 || model.outputs > 8}}) {
      EXPECT_EQ(std::count(entry.classes.begin(), entry.classes.end(), name), expected ? 1 : 0)
          << model.designation << ": " << name;
    }
  }
}

}  // namespace
}  // namespace ex9000::conformance
