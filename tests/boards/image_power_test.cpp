// Tests power cuts, and the first start after an update of the firmware. After a power cut, a new emulator
// uses the EEPROM file of the previous one.
//
// The emulated EEPROM stores a page immediately when STOP arrives. Therefore no cut in this test leaves a
// page that is only partly stored. power_cuts_test checks such pages.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_line/wires/module.hpp"
#include "tests/firmware/settings/stored_bytes.hpp"
#include "tests/qemu/master.hpp"
#include "tests/qemu/timed_module.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/settings_reader.hpp"
#include "tests/support/storing_commands.hpp"

namespace ex9000::rig {
namespace {

using std::chrono::milliseconds;

TEST(ImageWithoutPower, KeepsItsSettings) {
  const Model& model = *find_model("EX9042D-M");
  const Settings settings = ascii(model);
  TimedModule module(model);
  module.begin_anew(&settings);
  module.run_for(kComesUpWithin);
  EXPECT_EQ(ask(module, "~01OPUMP 7"), "!01");
  EXPECT_EQ(ask(module, "%0102400600"), "!02");
  EXPECT_EQ(ask(module, "@021234"), ">");
  EXPECT_EQ(ask(module, "~025P"), "!02");
  module.kill();
  EXPECT_EQ(module.outputs(), 0);
  module.power(true);
  module.run_for(kComesUpWithin);
  EXPECT_EQ(ask(module, "$02M"), "!02PUMP 7");
  EXPECT_EQ(ask(module, "@02"), ">1234");
  EXPECT_EQ(module.outputs(), 0x1234);
  EXPECT_EQ(ask(module, "$025"), "!021");
}

/// Returns the settings before `command`, which changes them.
Settings settings_before(const Model& model, const StoringCommand& command) {
  Settings settings = Settings::factory(model);
  if (command.init != Init::SinceReset) {
    settings.protocol = command.protocol;
  }
  settings.power_on_value = 0x5A5A;
  settings.safe_value = 0xA5A4;
  command.prepare(settings);
  return settings;
}

/// The time limit for all writes of one command to the registers of the I2C master. The limit includes the
/// wait for a timeout of the host watchdog, and 2 ms for each write before which the module stops.
constexpr milliseconds kStoresWithin{3000};

/// A module whose emulator is killed before a selected write to the registers of the I2C master.
class CutModule {
 public:
  CutModule(const Model& model, const StoringCommand& command)
      : command_(command), before_(settings_before(model, command)), module_(model) {}

  /// Starts the module, and sends the command or waits for the timeout of the host watchdog. The power fails
  /// immediately before write number `stores` (counted from 1) to the registers of the I2C master. If
  /// `stores` is 0, the power fails when the command has been sent, or before the wait. If fewer writes occur
  /// within kStoresWithin, the power fails after this time, and the function returns false.
  bool cut_behind(unsigned stores) {
    constexpr std::uint32_t kI2c = 0x4002'0000;
    constexpr std::uint32_t kRegisters = 0x24;
    const bool init_mode = command_.init == Init::SinceReset;
    module_.power(false);
    store(before_);
    power_up(init_mode);
    SettingsReader master = spoken_to(init_mode ? FrameFormat::init_mode() : FrameFormat::of(before_));
    if (!before_.timeout_status) {
      const bool driven = before_.protocol == Protocol::Ascii || init_mode
                              ? master.ask(std::string("@C35A")) == ">"
                              : master.ask(Bytes{0x0F, 0, 0, 0, 16, 2, 0x5A, 0xC3}).size() == 6;
      EXPECT_TRUE(driven);
    }
    if (command_.init == Init::Tied) {
      module_.set_init(true);
      module_.run_for(milliseconds(25));  // a change of INIT* takes effect within 20 ms: wire.md D13
    }
    done_ = command_.done_to(before_, module_.outputs());
    module_.hear(module_.mode());
    if (!command_.is_timeout()) {
      const FrameFormat frame_format = init_mode ? FrameFormat::init_mode() : FrameFormat::of(before_);
      module_.send(frame_format.framed(command_.frame(before_)), module_.mode());
    }
    module_.watch_stores(kI2c, kRegisters);
    bool stopped = true;
    for (unsigned i = 0; i < stores && stopped; ++i) {
      stopped = module_.run_to_store(kStoresWithin);
    }
    answered_ = !module_.hear(module_.mode()).empty();
    module_.kill();
    return stopped;
  }

  /// Checks that the module starts with the old or the new settings, and with the matching outputs. The
  /// settings must be the new ones if `must_be_done` is true, or if the module began to reply before the
  /// power failed.
  void expect_wholly_done_or_not_at_all(bool must_be_done) {
    module_.set_init(false);
    power_up(false);
    const std::uint16_t outputs = module_.outputs();
    // The replies depend only on the contents of the EEPROM. Therefore the test reads the settings only once
    // if several cuts leave the same contents.
    std::optional<Settings>& found = known_[module_.memory()];
    for (const Settings* guess : {&done_, &before_}) {
      if (!found && is_used(guess->baud_code)) {
        found = spoken_to(FrameFormat::of(*guess)).read(guess->format);
      }
    }
    ASSERT_TRUE(found) << "the module does not reply";
    ASSERT_TRUE(*found == done_ || (!must_be_done && !answered_ && *found == before_));
    ASSERT_EQ(outputs, found->timeout_status ? found->safe_value : found->power_on_value);
    (*found == done_ ? news_ : olds_) += 1;
  }

  [[nodiscard]] bool answered() const { return answered_; }
  [[nodiscard]] unsigned olds() const { return olds_; }
  [[nodiscard]] unsigned news() const { return news_; }

 private:
  using Bytes = std::vector<std::uint8_t>;

  void store(const Settings& settings) {
    const Bytes image = sim::SimulatedModule::memory_image(module_.model(), settings);
    module_.set_memory({image.begin(), image.end()});
  }
  void power_up(bool init) {
    module_.set_init(init);
    module_.power(true);
    module_.run_for(milliseconds(60));
    ASSERT_NE(module_.mode().baud, 0U) << "the module does not start";
  }
  /// Returns whether the module uses the line format of `code`, and a baud rate within 5 % of the baud rate
  /// of `code`.
  bool is_used(std::uint8_t code) {
    const std::uint32_t rate = baud_rate(code);
    const hal::SerialMode mode = module_.mode();
    return mode.format == line_format(code) && mode.baud > rate - rate / 20 && mode.baud < rate + rate / 20;
  }
  SettingsReader spoken_to(const FrameFormat& frame_format) {
    return {module_.model(), frame_format, [this](const Bytes& frame) {
              constexpr milliseconds kSilence{5};
              module_.run_for(kSilence);
              module_.hear(module_.mode());
              module_.send(frame, module_.mode());
              module_.run_for(kSilence);
              return module_.hear(module_.mode());
            }};
  }

  const StoringCommand& command_;
  Settings before_;
  Settings done_;
  TimedModule module_;
  std::map<std::string, std::optional<Settings>> known_;  ///< the settings, by contents of the EEPROM
  bool answered_ = false;
  unsigned olds_ = 0;
  unsigned news_ = 0;
};

/// Returns a reader of the settings of `module`. The module must have started.
SettingsReader reader_of(TimedModule& module, const FrameFormat& frame_format) {
  return {module.model(), frame_format, [&module](const std::vector<std::uint8_t>& frame) {
            constexpr milliseconds kSilence{5};
            module.run_for(kSilence);
            module.hear(module.mode());
            module.send(frame, module.mode());
            module.run_for(milliseconds(100));
            return module.hear(module.mode());
          }};
}

TEST(ImageAfterAnUpdate, HasAllSettingsThatEarlierFirmwareHasStored) {
  unsigned updates = 0;
  for (const StoredBytes& stored : all_stored_bytes()) {
    if (stored.model->designation != "EX9042D-M" && stored.model->designation != "EX9055D") {
      continue;
    }
    std::string memory(0x2000, '\xFF');  // an AT24C64
    std::copy(stored.memory.begin(), stored.memory.end(), memory.begin());
    TimedModule module(*stored.model);
    module.power(false);
    module.set_memory(memory);
    module.power(true);
    module.run_for(kComesUpWithin);
    const auto found = reader_of(module, FrameFormat::of(stored.settings)).read(stored.settings.format);
    ASSERT_TRUE(found) << stored.file << ": the module does not reply";
    EXPECT_TRUE(*found == stored.settings) << stored.file;
    EXPECT_EQ(module.memory(), memory) << stored.file;
    ++updates;
  }
  EXPECT_GE(updates, 2U);  // two models
}

TEST(ImageWithoutPower, HasOldOrNewSettingsAfterAPowerCutBetweenAnyTwoI2cRegisterWrites) {
  const Model& model = *find_model("EX9043D-M");
  unsigned cuts = 0;
  unsigned commands = 0;
  for (const StoringCommand& command : storing_commands(model)) {
    if (!all_cases_requested() && command.name != "~AAO") {
      continue;
    }
    SCOPED_TRACE(command.name);
    CutModule module(model, command);
    ++commands;
    for (unsigned stores = 0;; ++stores) {
      SCOPED_TRACE(std::to_string(stores) + " stores");
      const bool stopped = module.cut_behind(stores);
      module.expect_wholly_done_or_not_at_all(!stopped);
      ASSERT_FALSE(HasFatalFailure());
      ++cuts;
      if (!stopped) {
        EXPECT_EQ(module.answered(), command.answered);
        break;
      }
    }
    EXPECT_GT(module.olds(), 20U);
    EXPECT_GT(module.news(), 20U);
  }
  std::printf("%u cuts in %u commands\n", cuts, commands);
}

}  // namespace
}  // namespace ex9000::rig
