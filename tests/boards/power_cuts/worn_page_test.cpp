// Tests a module with a worn-out EEPROM: the EEPROM acknowledges everything, but some bits of one byte keep a
// fixed value. The firmware reads back each page of a new copy, so wire.md section 8 still applies: "If a
// write fails, the module replies `?AA` or exception 04, and nothing changes." The firmware tries a store
// three times before it refuses the command, and the store of a timeout once a second (wire.md D15).
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/boards/images_under_test.hpp"
#include "tests/boards/power_cuts/cut_bench.hpp"
#include "tests/boards/power_cuts/stored_state.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::registers {
namespace {

constexpr unsigned kTries = 3;

struct Stuck {
  std::uint16_t place;  ///< offset in the page
  std::uint8_t bits;
  std::uint8_t at;  ///< the value that these bits keep
};
/// In a record of one page, these bytes belong to the sequence number (2), the address (4), the name (14) and
/// the check (23 to 25). One bit, several bits or all bits of the byte are stuck.
constexpr Stuck kStuck[] = {{23, 0xFF, 0x00}, {4, 0x80, 0x80},  {25, 0xFF, 0xFF},
                            {2, 0x03, 0x03},  {24, 0x55, 0xAA}, {14, 0xFF, 0x00}};

/// Returns the number of pages of a record with these settings. A record of 19 bytes of settings, the
/// minimum, has one page.
unsigned pages_of(const Settings& settings) { return StoredCopy::bytes_of(settings) > 19 ? 2 : 1; }

class WornPageOf : public testing::TestWithParam<ImageName> {
 protected:
  WornPageOf() : bench_(image_of(GetParam().board, GetParam().model), model_) {}

  /// Checks the reply, the outputs, the contents of the EEPROM, and the next start of the module. `done`
  /// says whether the command must be stored.
  void judge(const State& state, const StoringCommand& command, const Attempt& attempt, bool done) {
    const Settings wanted = command.done_to(state.settings, attempt.outputs_before);
    // A timeout that cannot be stored is tried again with another sequence number and another check, which
    // the stuck bits may permit (wire.md D15).
    const bool later = command.is_timeout() && settings_in(model_, attempt.behind.back()) == wanted;
    const Settings found = done || later ? wanted : state.settings;
    for (const Contents& contents : attempt.meanwhile) {
      const Settings now = settings_in(model_, contents);
      ASSERT_TRUE(now == state.settings || now == wanted);
    }
    const bool answers = command.answered;
    for (const Contents& contents : attempt.behind) {
      const Settings now = settings_in(model_, contents);
      ASSERT_TRUE(answers ? now == found : now == state.settings || now == wanted);
    }
    ASSERT_TRUE(settings_in(model_, attempt.behind.back()) == found);
    if (answers) {
      ASSERT_GE(attempt.reply.size(), 3U) << "no reply";
      const bool ascii = command.protocol == Protocol::Ascii;
      ASSERT_EQ(ascii ? attempt.reply[0] == '!' : attempt.reply[1] < 0x80U, done);
      if (!done) {
        ASSERT_TRUE(ascii ? attempt.reply[0] == '?' : attempt.reply[2] == 4U);
      }
    }
    // A timeout changes the outputs even if it cannot be stored.
    const bool drives = command.drive && (done || command.is_timeout());
    ASSERT_EQ(attempt.outputs,
              drives ? command.drive(wanted, attempt.outputs_before) : attempt.outputs_before);
    const Found up = bench_.come_up(attempt.behind.back(), {found}, false);
    ASSERT_TRUE(up.settings) << "the module does not reply";
    ASSERT_TRUE(*up.settings == found);
    ASSERT_EQ(up.outputs.now, outputs_from_reset(found));
    ASSERT_EQ(up.outputs.ever_on, up.outputs.now);
  }

  const Model& model_ = *find_model(GetParam().model);
  CutBench bench_;
};

TEST_P(WornPageOf, StoresEachCommandCompletelyOrRefusesIt) {
  unsigned refused = 0;
  unsigned accepted = 0;
  unsigned number = 0;
  for (const Beginning beginning : {Beginning::Factory, Beginning::Full}) {
    for (const StoringCommand& command : storing_commands(model_)) {
      const State state = begin_at(beginning, model_, command);
      const bool second_counts = place_that_counts(model_, state.contents.data()) == kStoredPlaces[1];
      // The worn-out byte has no effect if the store does not write to it, or if its stuck bits have the
      // values that the store writes.
      for (const bool of_the_one_that_counts : {false, true}) {
        const Stuck& stuck = kStuck[number++ % std::size(kStuck)];
        const std::size_t page = kStoredPlaces[second_counts == of_the_one_that_counts ? 1 : 0];
        SCOPED_TRACE(command.name + (beginning == Beginning::Factory ? ", factory state" : ", set up") +
                     ", byte " + std::to_string(page + stuck.place) + " worn out");
        const Attempt attempt =
            bench_.attempt(state.contents, state.settings, command,
                           static_cast<std::uint16_t>(page + stuck.place), stuck.bits, stuck.at);
        const bool done = attempt.spoiled == 0;
        const Settings wanted = command.done_to(state.settings, attempt.outputs_before);
        const unsigned most_tries = command.is_timeout() ? 1 : kTries;
        ASSERT_EQ(attempt.tries, done ? pages_of(wanted) : most_tries);
        judge(state, command, attempt, done);
        ASSERT_FALSE(HasFailure());
        (done ? accepted : refused) += 1;
      }
    }
  }
  std::printf("a worn page: %u commands or timeouts not stored, %u stored\n", refused, accepted);
  EXPECT_GT(refused, number / 3);
  EXPECT_GT(accepted, number / 3);
}

/// wire.md sections 3 and 7: the latest start of a reply to a command that stores is 200 ms after the end of
/// the frame.
TEST_P(WornPageOf, CausesARefusalInTimeWithTheLongestRecordAndTheSlowestPages) {
  constexpr std::uint8_t kLongest = 120;
  constexpr std::uint16_t kInTheLastPage = 0x60 + 5;
  constexpr std::chrono::milliseconds kInTime{200};
  bench_.set_programming_time(std::chrono::microseconds(9900));
  for (const StoringCommand& command : storing_commands(model_)) {
    if (!command.answered) {
      continue;
    }
    SCOPED_TRACE(command.name);
    State state = begin_at(Beginning::Longer, model_, command);
    lengthen(model_, state.contents.data(), kStoredPlaces[1], kLongest);
    const Attempt attempt = bench_.attempt(state.contents, state.settings, command,
                                           kStoredPlaces[0] + kInTheLastPage, 0xFF, 0x00);
    ASSERT_EQ(attempt.spoiled, kTries);
    ASSERT_EQ(attempt.tries, 3 + kTries);  // the first three pages are programmed once each
    ASSERT_LT(attempt.reply_after, kInTime);
    judge(state, command, attempt, false);
    ASSERT_FALSE(HasFailure());
  }
}

INSTANTIATE_TEST_SUITE_P(Images, WornPageOf, testing::Values(ImageName{"ek-tm4c123gxl", "EX9043D-M"}),
                         name_of);

}  // namespace
}  // namespace ex9000::registers
