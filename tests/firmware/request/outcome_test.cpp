// Tests the outcome of a request: an outcome has exactly the requested effects, and a cleared outcome has
// none.
#include "firmware/request/outcome.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace ex9000 {
namespace {

const Model& the_model() { return *find_model("EX9042D-M"); }

const std::vector<Effect> kEveryEffect{
    Effect::RestartHostWatchdog, Effect::TakeAddress,      Effect::TakeCountingEdge, Effect::TakeSample,
    Effect::MarkSampleRead,      Effect::ClearResetStatus, Effect::ClearLatches,     Effect::ClearDiagnostics,
    Effect::ClearCounters,       Effect::ClearTimeoutCount};

Outcome of_everything() {
  Outcome outcome;
  for (const Effect effect : kEveryEffect) {
    outcome.request(effect);
  }
  outcome.counters_to_clear = 0xFF;
  outcome.drive({0x1FFF, 0x0AAA});
  outcome.drive_for(3, 10);
  outcome.change().address = 0x2A;
  outcome.change().safe_value = 0x1234;
  return outcome;
}

void expect_nothing(const Outcome& outcome) {
  EXPECT_FALSE(outcome.has_effects());
  for (const Effect effect : kEveryEffect) {
    EXPECT_FALSE(outcome.asks_for(effect));
  }
  EXPECT_EQ(outcome.outputs_to_drive().mask, 0);
  EXPECT_EQ(outcome.timed_outputs_to_drive().mask, 0);
  EXPECT_FALSE(outcome.changes_settings());
  const Settings factory = Settings::factory(the_model());
  EXPECT_TRUE(outcome.change().applied_to(factory) == factory);
}

TEST(Outcome, IsEmptyAtFirst) {
  const Outcome outcome;
  expect_nothing(outcome);
  EXPECT_EQ(outcome.refusal, Refusal::None);
}

TEST(Outcome, HasTheEffectsThatWereRequestedAndNoOthers) {
  for (const Effect one : kEveryEffect) {
    for (const Effect other : kEveryEffect) {
      Outcome outcome;
      outcome.request(one);
      outcome.request(other);
      EXPECT_TRUE(outcome.has_effects());
      for (const Effect each : kEveryEffect) {
        EXPECT_EQ(outcome.asks_for(each), each == one || each == other);
      }
      EXPECT_EQ(outcome.outputs_to_drive().mask, 0);
      EXPECT_FALSE(outcome.changes_settings());
    }
  }
}

TEST(Outcome, DrivingOutputsRequestsNoEffectAndChangesNoSettings) {
  Outcome outcome;
  outcome.drive({0x0003, 0x0002});
  EXPECT_FALSE(outcome.has_effects());
  EXPECT_FALSE(outcome.changes_settings());
  EXPECT_EQ(outcome.outputs_to_drive().mask, 0x0003);
  EXPECT_EQ(outcome.outputs_to_drive().value, 0x0002);
}

TEST(Outcome, ChangingSettingsRequestsNoEffectAndDrivesNoOutputs) {
  Outcome outcome;
  outcome.change().address = 0x2A;
  outcome.change().watchdog_timeout = 0x64;
  EXPECT_FALSE(outcome.has_effects());
  EXPECT_TRUE(outcome.changes_settings());
  EXPECT_EQ(outcome.outputs_to_drive().mask, 0);
  Settings expected = Settings::factory(the_model());
  expected.address = 0x2A;
  expected.watchdog_timeout = 0x64;
  EXPECT_TRUE(outcome.change().applied_to(Settings::factory(the_model())) == expected);
}

TEST(Outcome, AClearedOutcomeIsEmpty) {
  Outcome outcome = of_everything();
  outcome.clear();
  expect_nothing(outcome);
}

TEST(Outcome, AClearedOutcomeKeepsItsRefusal) {
  Outcome outcome = of_everything();
  outcome.refusal = Refusal::OutOfRange;
  outcome.clear();
  expect_nothing(outcome);
  EXPECT_EQ(outcome.refusal, Refusal::OutOfRange);
}

// A module uses one outcome object for all requests.
TEST(Outcome, AClearedOutcomeHasOnlyLaterEffects) {
  Outcome outcome = of_everything();
  outcome.clear();
  outcome.change().watchdog_timeout = 0x64;
  outcome.request(Effect::TakeSample);
  Settings expected = Settings::factory(the_model());
  expected.watchdog_timeout = 0x64;
  EXPECT_TRUE(outcome.change().applied_to(Settings::factory(the_model())) == expected);
  EXPECT_TRUE(outcome.asks_for(Effect::TakeSample));
  EXPECT_FALSE(outcome.asks_for(Effect::TakeAddress));
  EXPECT_EQ(outcome.outputs_to_drive().mask, 0);
  outcome.drive({0x0001, 0x0001});
  EXPECT_EQ(outcome.outputs_to_drive().mask, 0x0001);
  EXPECT_EQ(outcome.outputs_to_drive().value, 0x0001);
}

}  // namespace
}  // namespace ex9000
