// Tests the host watchdog of an image (wire.md section 6): when the host watchdog expires, and which values
// the outputs have after the expiry. In some tests, the module receives commands or stores settings at the
// expiry, or a power cut follows the expiry.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/boards/images_under_test.hpp"
#include "tests/boards/watched_module.hpp"
#include "tests/mcu_model/board_bench.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::registers {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// The longest delay with which the module may restart its host watchdog. The module's clock counts
/// microseconds. The module rounds up the end of a byte and the end of the silence after the byte, so that
/// the host watchdog does not expire too early.
constexpr microseconds kRounding{3};
/// The longest permitted time from the first interrupt after the expiry until the main loop has set the last
/// of sixteen pins. The pins change one after the other. The measured time is 2.5 us.
constexpr microseconds kTurn{5};
constexpr milliseconds kExpiresWithin{1};

class HostWatchdogOnBoard : public WatchedImage {
 protected:
  /// Clears the timeout status, drives the outputs to kDriven, and enables the host watchdog with `timeout`,
  /// in units of 0.1 s.
  static void arm(WatchedModule& module, unsigned timeout) {
    module.ask("~013001", {1, 0x05, 0x01, 0x04, 0, 0});
    module.ask("~011", {1, 0x05, 0x01, 0x0D, 0xFF, 0});
    module.ask("", {1, 0x06, 0x01, 0xE8, 0, static_cast<std::uint8_t>(timeout)});
    ASSERT_TRUE(module.drive(kDriven));
    module.ask("~0131" + hex(timeout), {1, 0x05, 0x01, 0x04, 0xFF, 0});
  }
  /// Clears the timeout status. Restores the power-on value and the name, which the tested commands may have
  /// changed.
  static void restore(WatchedModule& module) {
    module.ask("~011", {1, 0x05, 0x01, 0x0D, 0xFF, 0});
    module.drive(kPowerOnValue);
    module.ask("~015P", {1, 0x0F, 0, 0xA0, 0, 16, 2, kPowerOnValue & 0xFFU, kPowerOnValue >> 8U});
    module.ask("~01O9043M", {1, 0x11});
  }
};

/// Tests expiries immediately before a tick, immediately after a tick, and at other times.
class ExpiryOnBoard : public HostWatchdogOnBoard {
 protected:
  void expect_expiry_within(Instant most, const std::function<void(BoardBench&)>& prepare);
};

void ExpiryOnBoard::expect_expiry_within(Instant most, const std::function<void(BoardBench&)>& prepare) {
  WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
  BoardBench& bench = module.bench;
  prepare(bench);
  Instant earliest = kNever;
  Instant latest{0};
  const unsigned step = all_cases_requested() ? 1 : module.ascii() ? 5 : 11;
  unsigned timeouts = 0;
  for (unsigned timeout = 1; timeout <= 0xFF; timeout += step, ++timeouts) {
    SCOPED_TRACE(timeout);
    arm(module, timeout);
    module.wait_until_a_host_ok_is_over_behind_a_tick(timeouts % 3 == 0   ? -kRounding
                                                      : timeouts % 3 == 1 ? kRounding
                                                                          : timeout * microseconds(3));
    const Instant over = module.host_ok() + timeout * milliseconds(100);
    module.changes.clear();
    bench.run_until(over + milliseconds(20));
    ASSERT_FALSE(module.changes.empty());
    for (const WatchedModule::Change& change : module.changes) {
      earliest = std::min(earliest, change.at - over);
      latest = std::max(latest, change.at - over);
    }
    ASSERT_EQ(bench.outputs(), kSafeValue);
  }
  EXPECT_GE(earliest, Instant(0));
  EXPECT_LE(latest, most);
  std::printf("%u timeouts: the outputs changed %.3f to %.3f ms after the expiry\n", timeouts,
              static_cast<double>(earliest.count()) / 1e9, static_cast<double>(latest.count()) / 1e9);
}

TEST_P(ExpiryOnBoard, IsNeverEarlyAndAtMostOneMillisecondLate) {
  expect_expiry_within(kExpiresWithin, [](BoardBench& /*bench*/) {});
}

TEST_P(ExpiryOnBoard, IsAtMostOneTickLateIfTheWakeTimerFails) {
  expect_expiry_within(kTick + kRounding + kTurn,
                       [](BoardBench& bench) { bench.mcu->timer2.write(TimerBlock::kMask, 0); });
}

/// Sends commands that end at different times before and after the expiry: a command that only drives
/// outputs, a command that stores a power-on value (in Modbus, it also drives the outputs), and a command
/// that drives outputs while the module stores the setting of the previous command.
TEST_P(HostWatchdogOnBoard, NoCommandDrivesOutputsAfterTheExpiry) {
  constexpr unsigned kVv = 5;
  constexpr std::uint16_t kCommanded = 0x3C96;
  const Instant step = all_cases_requested() ? microseconds(100) : microseconds(2300);
  WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
  BoardBench& bench = module.bench;
  const Bytes drives = module.drive_frame(kCommanded);
  const Bytes stores = module.framed("~01OPUMP", {1, 0x05, 0, 0xA1, 0, 0});
  const Bytes stores_and_drives =
      module.framed("~015P", {1, 0x0F, 0, 0xA0, 0, 16, 2, kCommanded & 0xFFU, kCommanded >> 8U});
  unsigned moments = 0;
  unsigned too_late = 0;
  for (const auto& [first, second] :
       {std::pair<Bytes, Bytes>(drives, {}), {stores_and_drives, {}}, {stores, drives}}) {
    for (Instant early{0}; early < milliseconds(60); early += step, ++moments) {
      SCOPED_TRACE(std::to_string(early.count() / 1'000'000) + " us before");
      arm(module, kVv);
      const Instant over = module.host_ok() + kVv * milliseconds(100);
      bench.run_until(over - early);
      bench.line.send(first);
      while (bench.line.sending()) {
        bench.run_for(microseconds(50));
      }
      if (!second.empty()) {
        bench.run_for(milliseconds(6));  // the module now stores the setting of the first command
        bench.line.send(second);
      }
      bench.run_until(std::max(bench.timeline.now(), over + kExpiresWithin));
      const bool in_time = bench.timeline.now() == over + kExpiresWithin;
      EXPECT_EQ(bench.outputs(), kSafeValue);
      module.changes.clear();
      bench.run_for(milliseconds(100));
      EXPECT_TRUE(module.changes.empty());
      EXPECT_TRUE(module.timeout_status());
      too_late += in_time ? 0U : 1U;
      ASSERT_FALSE(HasFailure());
      restore(module);
    }
  }
  EXPECT_GT(moments, 2 * too_late);
  std::printf(
      "%u cases; in %u cases, a single command ended or a second command began more than 1 ms after the "
      "expiry\n",
      moments, too_late);
}

/// wire.md D6. If the module is storing a new safe value at the expiry, the outputs first take the old safe
/// value. When the new safe value is stored, the outputs take the new safe value. After the expiry, the
/// outputs never take the value of a later command.
TEST_P(HostWatchdogOnBoard, IfASafeValueIsBeingStoredAtTheExpiryTheOutputsTakeItAfterTheStore) {
  constexpr unsigned kVv = 5;
  constexpr std::uint16_t kCommanded = 0x3C96;
  // `~AA5S` stores the driven value.
  const std::uint16_t new_value = protocol() == Protocol::Ascii ? kDriven : 0x0FF0;
  const Instant step = all_cases_requested() ? microseconds(100) : microseconds(1100);
  WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
  BoardBench& bench = module.bench;
  const auto store_safe_value = [&module](std::uint16_t value) {
    return module.framed("~015S", {1, 0x0F, 0, 0x80, 0, 16, 2, static_cast<std::uint8_t>(value & 0xFFU),
                                   static_cast<std::uint8_t>(value >> 8U)});
  };
  unsigned stored_before = 0;
  unsigned stored_behind = 0;
  unsigned too_late = 0;
  for (Instant early{0}; early < milliseconds(40); early += step) {
    SCOPED_TRACE(std::to_string(early.count() / 1'000'000) + " us before");
    arm(module, kVv);
    const Instant over = module.host_ok() + kVv * milliseconds(100);
    bench.run_until(over - early);
    const std::size_t had_programmed = bench.eeprom.programmed().size();
    bench.line.drives.clear();
    module.changes.clear();
    bench.line.send(store_safe_value(new_value));
    bool sent_behind = false;
    Instant stored = kNever;
    while (bench.timeline.now() < over + milliseconds(100)) {
      bench.run_for(microseconds(50));
      if (!sent_behind && !bench.line.sending() &&
          bench.line.sent() + milliseconds(6) < bench.timeline.now()) {
        bench.line.send(module.drive_frame(kCommanded));
        sent_behind = true;
      }
      if (stored == kNever && bench.eeprom.programmed().size() > had_programmed) {
        stored = bench.timeline.now();
      }
      if (bench.timeline.now() > over + kExpiresWithin) {
        const std::uint16_t outputs = bench.outputs();
        ASSERT_TRUE(outputs == kSafeValue || outputs == new_value) << outputs;
      }
    }
    bool expired = false;
    bool was_new = false;
    unsigned switched = 0;
    for (const WatchedModule::Change& change : module.changes) {
      if (change.at < over) {
        continue;
      }
      // The pins change one after the other. A pin that has the same level in both safe values does not
      // change.
      const bool is_new = change.outputs == new_value;
      expired = expired || change.outputs == kSafeValue;
      ASSERT_TRUE(!expired || ((change.outputs ^ kSafeValue) & ~(kSafeValue ^ new_value)) == 0);
      ASSERT_FALSE(was_new) << "the outputs change again after the new safe value";
      if (expired && is_new) {
        ++switched;
        EXPECT_GE(change.at, stored - microseconds(50));
        ASSERT_FALSE(bench.line.drives.empty());
        EXPECT_LE(change.at, bench.line.drives.front().from + microseconds(50));
      }
      was_new = is_new;
    }
    EXPECT_TRUE(module.timeout_status());
    const std::uint16_t safe_value = bench.outputs();
    if (safe_value == kSafeValue) {
      ++too_late;
    } else {
      (switched != 0 ? stored_behind : stored_before) += 1;
    }
    module.power_cycle();
    EXPECT_EQ(bench.outputs(), safe_value);
    ASSERT_FALSE(HasFailure());
    module.ask("~011", {1, 0x05, 0x01, 0x0D, 0xFF, 0});
    module.drive(kSafeValue);
    bench.exchange(store_safe_value(kSafeValue));
  }
  EXPECT_GT(stored_before, 0U);
  EXPECT_GT(stored_behind, 0U);
  EXPECT_GT(too_late, 0U);
  std::printf(
      "the new safe value was stored before the expiry in %u cases and after the expiry in %u cases; the "
      "command was too late in %u cases\n",
      stored_before, stored_behind, too_late);
}

/// The state of the EEPROM when the host watchdog expires: the module stores nothing, the module transfers a
/// command's settings on the EEPROM's bus, or the EEPROM programs these settings.
enum class Storing : std::uint8_t { Nothing, OnTheBus, Programming };

TEST_P(HostWatchdogOnBoard, NoCommandedValueReturnsAfterTheExpiryAndAPowerCut) {
  constexpr unsigned kVv = 9;
  constexpr std::uint16_t kOtherPowerOnValue = 0x3CC3;
  const Instant step = all_cases_requested() ? microseconds(50) : microseconds(700);
  WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
  BoardBench& bench = module.bench;
  unsigned events = 0;
  unsigned unstored = 0;
  unsigned cuts = 0;
  unsigned done = 0;
  // The test stores a name in ASCII and a power-on value in Modbus. In ASCII, `name` contains the last reply
  // with the name. `power_on_value` contains the stored power-on value.
  Bytes name = module.ask("$01M", {1, 0x11});
  std::uint16_t power_on_value = kPowerOnValue;
  for (const Storing storing : {Storing::Nothing, Storing::OnTheBus, Storing::Programming}) {
    for (Instant late{0}; late < milliseconds(30); late += step, ++cuts) {
      SCOPED_TRACE(std::to_string(late.count() / 1'000'000) + " us after, storing " +
                   std::to_string(static_cast<int>(storing)));
      const std::string new_name = name == module.text("!01PUMP") ? "VALVE" : "PUMP";
      const std::uint16_t new_value = power_on_value == kPowerOnValue ? kOtherPowerOnValue : kPowerOnValue;
      arm(module, kVv);
      const Instant over = module.host_ok() + kVv * milliseconds(100);
      if (storing != Storing::Nothing) {
        const Bytes command = module.framed(
            "~01O" + new_name, {1, 0x0F, 0, 0xA0, 0, 16, 2, static_cast<std::uint8_t>(new_value & 0xFFU),
                                static_cast<std::uint8_t>(new_value >> 8U)});
        const Instant character = bench.line.character_time();
        const Instant takes = static_cast<std::int64_t>(command.size()) * character +
                              (module.ascii() ? character : 77 * bench.line.bit_time() / 2);
        bench.run_until(over - takes -
                        (storing == Storing::OnTheBus ? microseconds(400) : microseconds(4000)));
        const std::size_t had_programmed = bench.eeprom.programmed().size();
        events = 0;
        bench.eeprom.on_event([&events] { ++events; });
        bench.line.drives.clear();
        bench.line.send(command);
        bench.run_until(over);
        // Without these conditions, the test would prove nothing.
        ASSERT_GT(events, 3U) << "nothing is being stored";
        ASSERT_EQ(bench.eeprom.programmed().size(), had_programmed) << "the command is already stored";
        ASSERT_EQ(bench.eeprom.programming(), storing == Storing::Programming);
        bench.eeprom.on_event(nullptr);
      }
      bench.run_until(over + kExpiresWithin + late);
      ASSERT_EQ(bench.outputs(), kSafeValue);
      const bool answered = storing != Storing::Nothing && !bench.line.drives.empty();
      module.changes.clear();
      module.power_cycle();
      const bool stored = module.timeout_status();
      const std::uint16_t outputs = bench.outputs();
      if (storing != Storing::Nothing) {
        const Bytes now = module.ask("$01M", {1, 0x01, 0, 0xA0, 0, 16});
        const Bytes wanted =
            module.framed("!01" + new_name, {1, 0x01, 2, static_cast<std::uint8_t>(new_value & 0xFFU),
                                             static_cast<std::uint8_t>(new_value >> 8U)});
        const Bytes old =
            module.ascii() ? name
                           : module.framed("", {1, 0x01, 2, static_cast<std::uint8_t>(power_on_value & 0xFFU),
                                                static_cast<std::uint8_t>(power_on_value >> 8U)});
        ASSERT_TRUE(now == wanted || (now == old && !answered));
        name = now;
        power_on_value = now == wanted && !module.ascii() ? new_value : power_on_value;
        done += now == wanted ? 1U : 0U;
      }
      const std::uint16_t from_reset = stored ? kSafeValue : power_on_value;
      EXPECT_EQ(outputs, from_reset);
      for (const WatchedModule::Change& change : module.changes) {
        // Until the supply is switched on again, only outputs that are on in the safe value are on. After
        // that, only outputs that are on in the value after a reset are on.
        EXPECT_EQ(change.at < bench.began ? change.outputs & ~kSafeValue : change.outputs & ~from_reset, 0);
      }
      unstored += stored ? 0U : 1U;
      EXPECT_EQ(module.enabled(), !stored);
      EXPECT_EQ(module.drive(kDriven), !stored);
      EXPECT_EQ(bench.outputs(), stored ? kSafeValue : kDriven);
      ASSERT_FALSE(HasFailure());
      module.ask("~011", {1, 0x05, 0x01, 0x0D, 0xFF, 0});
    }
  }
  EXPECT_GT(unstored, 0U);
  EXPECT_LT(unstored, cuts / 2);
  EXPECT_GT(done, 0U);
  std::printf(
      "%u power cuts; %u power cuts came before the timeout status was stored; the settings of %u commands "
      "were stored\n",
      cuts, unstored, done);
}

const auto kImages =
    testing::Combine(testing::Values(ImageName{"ek-tm4c123gxl", "EX9043D-M"}), kBothProtocols);
INSTANTIATE_TEST_SUITE_P(Images, ExpiryOnBoard, kImages, name_of_watched_image);
INSTANTIATE_TEST_SUITE_P(Images, HostWatchdogOnBoard, kImages, name_of_watched_image);

}  // namespace
}  // namespace ex9000::registers
