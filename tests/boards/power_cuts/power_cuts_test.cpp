// Tests power cuts at every point of each command of `storing_commands`, and of a timeout of the host
// watchdog: wire.md section 8, "At the next reset each *command* is either done completely or not done at
// all". A command to which the module has replied must be done. Also tests resets of the microcontroller
// during these commands.
//
// The image stores settings with its own drivers. StoredCopy, which has no code of the firmware, reads the
// settings from all contents that a cut may leave in the EEPROM. The image also starts from some of these
// contents, which a seed selects, and the test reads all settings of the module. With EX9000_CUTS=all in the
// environment, the tests with one cut start the image from all of these contents.
#include <gtest/gtest.h>

#include <algorithm>
#include <bitset>
#include <cstdio>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/boards/images_under_test.hpp"
#include "tests/boards/power_cuts/cut_bench.hpp"
#include "tests/boards/power_cuts/stored_state.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::registers {
namespace {

constexpr unsigned kSeed = 1;

class PowerCutsOf : public testing::TestWithParam<ImageName> {
 protected:
  PowerCutsOf()
      : model_(*find_model(GetParam().model)),
        commands_(storing_commands(model_)),
        bench_(image_of(GetParam().board, GetParam().model), model_) {}

  /// Checks that since the reset only the expected outputs have been switched on, and that none has been
  /// switched off again.
  void expect_outputs(const Outputs& outputs, const Settings& settings) {
    ASSERT_EQ(outputs.now, outputs_from_reset(settings));
    ASSERT_EQ(outputs.ever_on, outputs.now);
    ASSERT_EQ(outputs.changes, std::bitset<16>(outputs.now).count());
  }

  /// Starts the image from `contents`, in which StoredCopy has found `settings`. Checks that the module has
  /// these settings and that its outputs have the values that these settings require. `otherwise` are the
  /// settings that a faulty module might have instead.
  void come_up(const Contents& contents, const Settings& settings, const Settings& otherwise) {
    const Found found = bench_.come_up(contents, {settings, otherwise}, all_cases_requested());
    ASSERT_TRUE(found.settings) << "the module does not reply";
    ASSERT_TRUE(*found.settings == settings);
    expect_outputs(found.outputs, settings);
    ++booted_;
  }

  /// Checks all contents that the cuts have left, and starts the image from at most `by_the_image` of these
  /// contents. `unfinished` points to the settings that an earlier, interrupted command would have stored. If
  /// it is not null, the contents may also contain these settings; see the tests with two cuts.
  void judge(const Cuts& cuts, const Settings& before, const Settings& done, std::size_t by_the_image,
             const Settings* unfinished = nullptr) {
    points_ += cuts.points;
    cuts_ += cuts.cuts;
    distinct_ += cuts.left.size();
    for (const auto& [contents, certainly_done] : cuts.left) {
      const Settings found = settings_in(model_, contents);
      const bool finished_late =
          unfinished != nullptr && found == *unfinished && found != before && found != done;
      ASSERT_TRUE(found == done || (!certainly_done && (found == before || finished_late)));
      olds_ += found == before ? 1U : 0U;
      finished_late_ += finished_late ? 1U : 0U;
    }
    for (const Contents& contents : in_any_order(cuts)) {
      if (by_the_image-- == 0 || HasFatalFailure()) {
        return;
      }
      const Settings found = settings_in(model_, contents);
      come_up(contents, found, found == done ? before : done);
    }
  }

  template <class Do>
  void for_each_command(Do what) {
    for (const Beginning beginning : {Beginning::Factory, Beginning::Full}) {
      for (const StoringCommand& command : commands_) {
        SCOPED_TRACE(command.name + (beginning == Beginning::Factory ? ", factory state" : ", set up"));
        what(begin_at(beginning, model_, command), command);
        ASSERT_FALSE(HasFailure());
      }
    }
  }

  /// Calls `what` for commands in the two states in which every store programs several pages. With
  /// EX9000_CUTS=all, uses all commands that change the settings of the state. Otherwise, uses three random
  /// commands of these for each state.
  template <class Do>
  void for_some_commands_of_several_pages(Do what) {
    constexpr std::size_t kSome = 3;
    std::vector<const StoringCommand*> commands;
    for (const StoringCommand& command : commands_) {
      if (stores_from(begin_at(Beginning::Longer, model_, command).contents, command)) {
        commands.push_back(&command);
      }
    }
    std::shuffle(commands.begin(), commands.end(), random_);
    commands.resize(all_cases_requested() ? commands.size() : kSome);
    for (const StoringCommand* command : commands) {
      SCOPED_TRACE(command->name + ", longer record");
      what(begin_at(Beginning::Longer, model_, *command), *command);
      ASSERT_FALSE(HasFailure());
    }
  }

  /// Returns whether the command changes the settings in `contents`.
  [[nodiscard]] bool stores_from(const Contents& contents, const StoringCommand& command) const {
    const Settings settings = settings_in(model_, contents);
    return command.stores_from(settings, bench_.outputs_before(settings));
  }

  /// Checks at most `pairs` pairs. A pair consists of contents that a cut during `first` may leave, and of a
  /// second command. The test cuts the power at every point of the second command. If `pairs` is SIZE_MAX,
  /// the test combines each of the contents with every command that `storing_from` returns. Otherwise, it
  /// combines each of the contents with one of these commands, a random one.
  void cut_twice(const State& state, const StoringCommand& first, std::size_t pairs) {
    const Cuts cuts = bench_.cut_everywhere(state.contents, state.settings, first);
    const Settings unfinished = first.done_to(state.settings, cuts.outputs);
    for (const Contents& contents : in_any_order(cuts)) {
      const Settings settings = settings_in(model_, contents);
      for (const StoringCommand* second : storing_from(settings)) {
        if (HasFailure() || pairs == 0) {
          return;
        }
        pairs -= pairs == SIZE_MAX ? 0U : 1U;
        SCOPED_TRACE("then " + second->name);
        const Cuts again = bench_.cut_everywhere(contents, settings, *second);
        judge(again, settings, second->done_to(settings, again.outputs), 1, &unfinished);
        if (pairs != SIZE_MAX) {
          break;
        }
      }
    }
  }

  std::vector<Contents> in_any_order(const Cuts& cuts) {
    std::vector<Contents> contents;
    for (const auto& each : cuts.left) {
      contents.push_back(each.first);
    }
    std::shuffle(contents.begin(), contents.end(), random_);
    return contents;
  }

  /// Returns, in random order, all commands and timeouts that are possible in a module with these settings
  /// and that change them.
  std::vector<const StoringCommand*> storing_from(const Settings& settings) {
    std::vector<const StoringCommand*> commands;
    for (const StoringCommand& command : commands_) {
      if ((command.init == Init::SinceReset || command.protocol == settings.protocol) &&
          command.stores_from(settings, bench_.outputs_before(settings))) {
        commands.push_back(&command);
      }
    }
    std::shuffle(commands.begin(), commands.end(), random_);
    return commands;
  }

  void TearDown() override {
    std::printf(
        "%s: %zu cuts or resets at %zu points left %zu different contents; of these, %zu contain the old "
        "settings, and %zu contain the settings of an earlier, interrupted command; the image started from "
        "%zu of the contents (seed %u)\n",
        bench_name().c_str(), cuts_, points_, distinct_, olds_, finished_late_, booted_, kSeed);
  }
  static std::string bench_name() {
    return std::string(testing::UnitTest::GetInstance()->current_test_info()->name());
  }

  const Model& model_;
  std::vector<StoringCommand> commands_;
  CutBench bench_;
  std::mt19937 random_{kSeed};
  std::size_t points_ = 0;
  std::size_t cuts_ = 0;
  std::size_t distinct_ = 0;
  std::size_t olds_ = 0;
  std::size_t finished_late_ = 0;
  std::size_t booted_ = 0;
};

TEST_P(PowerCutsOf, LeaveEachCommandCompletelyStoredOrNotAtAll) {
  for_each_command([this](const State& state, const StoringCommand& command) {
    const Cuts cuts = bench_.cut_everywhere(state.contents, state.settings, command);
    judge(cuts, state.settings, command.done_to(state.settings, cuts.outputs),
          all_cases_requested() ? SIZE_MAX : 18);
  });
}

/// Tests the first store after an update, and the store of a record of four pages.
TEST_P(PowerCutsOf, DuringAMultiPageStoreLeaveEachCommandCompletelyStoredOrNotAtAll) {
  for_some_commands_of_several_pages([this](const State& state, const StoringCommand& command) {
    const Cuts cuts = bench_.cut_everywhere(state.contents, state.settings, command);
    judge(cuts, state.settings, command.done_to(state.settings, cuts.outputs),
          all_cases_requested() ? SIZE_MAX : 6);
  });
}

/// Starts the module with contents that a cut during a first command may leave, and cuts the power at every
/// point of a second command. With EX9000_CUTS=all, uses all such contents; otherwise, uses two of these
/// contents for each first command.
///
/// After the second cut, the settings of the first command may be valid although they were not valid after
/// the first cut. For example, the first cut left a single wrong byte in the copy, and the second store wrote
/// the byte that the first store would have written. The first command is then done completely, and no
/// command with a reply is lost.
TEST_P(PowerCutsOf, DuringTwoSuccessiveCommandsLeaveEachCommandCompletelyStoredOrNotAtAll) {
  for_each_command([this](const State& state, const StoringCommand& first) {
    cut_twice(state, first, all_cases_requested() ? SIZE_MAX : 2);
  });
}

/// The number of combinations of a first and a second cut grows with the square of the number of written
/// bytes. Therefore this test uses a random sample even with EX9000_CUTS=all.
TEST_P(PowerCutsOf, DuringTwoSuccessiveMultiPageStoresLeaveEachCommandStoredOrNotAtAll) {
  for_some_commands_of_several_pages([this](const State& state, const StoringCommand& first) {
    cut_twice(state, first, all_cases_requested() ? 200 : 2);
  });
}

/// Resets only the microcontroller, at events of the EEPROM (EepromChip::on_event). After the reset, the
/// EEPROM may still be programming a page.
TEST_P(PowerCutsOf, AResetOfTheMicrocontrollerLeavesEachCommandStoredOrNotAtAll) {
  const std::size_t one_in = all_cases_requested() ? 1 : 28;
  for_each_command([this, one_in](const State& state, const StoringCommand& command) {
    const Cuts cuts = bench_.cut_everywhere(state.contents, state.settings, command);
    const Settings done = command.done_to(state.settings, cuts.outputs);
    for (std::size_t i = random_() % one_in; i < cuts.events.size(); i += one_in) {
      Cuts one;
      const AfterReset after = bench_.reset_after(cuts.events[i], state.contents, state.settings, command);
      expect_outputs(after.outputs, settings_in(model_, after.contents));
      one.points = one.cuts = 1;
      one.left[after.contents] = after.certainly_done;
      judge(one, state.settings, done, 1);
      if (HasFailure()) {
        return;
      }
    }
  });
}

INSTANTIATE_TEST_SUITE_P(Images, PowerCutsOf,
                         testing::Values(ImageName{"ek-tm4c123gxl", "EX9043D-M"},
                                         ImageName{"ek-tm4c123gxl", "EX9052D-M"}),
                         name_of);

}  // namespace
}  // namespace ex9000::registers
