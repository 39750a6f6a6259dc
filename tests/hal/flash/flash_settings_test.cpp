// Tests the settings of a module in the page store: power cuts at every operation of the flash (wire.md
// section 8), and the durations of saving and loading.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "firmware/settings/settings_keeper.hpp"
#include "tests/firmware/settings/settings_store_bench.hpp"
#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000 {
namespace {

using hal::flash::FlashChip;
using hal::flash::PowerFailure;
using hal::flash::Session;
using hal::flash::Tear;

constexpr unsigned kSeed = 1;
constexpr std::uint64_t kReplyLimit = 200'000;  ///< us; wire.md sections 3 and 7

static_assert(kStoredMemory == hal::flash::kStoreSize,
              "kStoreSize: differs from kStoredMemory; expected exactly the bytes that the settings use");

/// A module's settings in a flash, from one reset to the next.
class OnFlash {
 public:
  explicit OnFlash(FlashChip& chip, SettingsKeeper keeper = SettingsKeeper(the_model()))
      : chip_(chip), run_(chip), keeper_(keeper) {
    drive();
  }
  /// Saves `settings` and sets `latency`. Returns whether the save succeeded.
  bool save(const Settings& settings) {
    const std::uint64_t began = chip_.now;
    keeper_.save(settings, chip_.time());
    drive();
    latency = chip_.now - began;
    return keeper_.saved();
  }
  /// Runs the main loop for at least `microseconds` without a command. The keeper carries out the actions
  /// that belong to no command (see SettingsKeeper), and the store erases free sectors.
  void idle(std::uint64_t microseconds) {
    for (const std::uint64_t end = chip_.now + microseconds; chip_.now < end;) {
      keeper_.poll(keeper_.stored(), chip_.time());
      drive();
      run_.turn();
    }
  }
  void settle() {
    idle(10'000);
    run_.settle();
  }
  [[nodiscard]] const Settings& stored() const { return keeper_.stored(); }
  [[nodiscard]] const SettingsKeeper& keeper() const { return keeper_; }
  std::uint64_t latency = 0;  ///< us, of the last save

 private:
  void drive() {
    while (keeper_.busy()) {
      const MemoryJob job = keeper_.job();
      hal::flash::Store& store = run_.store();
      if (job.kind == MemoryJob::Kind::Read) {
        store.start_read(job.address, job.bytes, chip_.time());
      } else {
        store.start_write(job.address, {job.bytes.data, job.bytes.size}, chip_.time());
      }
      keeper_.done(run_.finish());
    }
  }

  FlashChip& chip_;
  Session run_;
  SettingsKeeper keeper_;
};

/// Returns a flash that holds the pages of `memory`.
FlashChip flash_with(const FakeMemory& memory) {
  FlashChip chip;
  Session run(chip);
  run.settle();
  for (std::size_t at = 0; at < kStoredMemory; at += kPage) {
    const Bytes page{&memory.cells[at], kPage};
    if (!is_blank(page)) {
      EXPECT_TRUE(run.write(at, page));
    }
  }
  run.settle();
  return chip;
}

struct Beginning {
  const char* what;
  FlashChip chip;
  Settings settings;
};

std::vector<Beginning> beginnings() {
  const FakeMemory blank;
  FakeMemory one;
  put(one, 0, numbered(100), 1);
  FakeMemory two = one;
  put(two, 1, numbered(101), 2);
  FakeMemory longer;
  put_longer(longer, 0, numbered(6), 8, 96);
  put_longer(longer, 1, numbered(5), 7, 120);
  // The next save frees the sector of the older copy, so the store erases this sector.
  Beginning apart{"copies in two sectors", {}, numbered(101)};
  for (const unsigned number : {100U, 101U}) {
    OnFlash module(apart.chip);
    module.settle();
    EXPECT_TRUE(module.save(numbered(number)));
  }
  Beginning used{"many saves", flash_with(two), {}};
  OnFlash module(used.chip);
  for (unsigned i = 0; i < 200; ++i) {
    used.settings = numbered(1000 + i);
    EXPECT_TRUE(module.save(used.settings));
  }
  return {{"blank", flash_with(blank), factory()},
          {"one copy", flash_with(one), numbered(100)},
          {"two copies", flash_with(two), numbered(101)},
          apart,
          {"longer records", flash_with(longer), numbered(6)},
          used};
}

std::vector<Tear> tears(FlashChip::Operation operation) {
  const bool erase = operation == FlashChip::Operation::Erase;
  std::vector<Tear> all;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    for (const Tear::Kind kind : Tear::kEveryKind) {
      all.push_back({kind, (erase ? FlashChip::kSector : hal::flash::kEntrySize) * seed / 6, seed});
    }
  }
  for (std::size_t prefix = 0; !erase && prefix <= hal::flash::kEntrySize; ++prefix) {
    all.push_back({Tear::Kind::Prefix, prefix, 1});
  }
  return all;
}

/// Starts a module, runs it for 2 ms, saves `to`, and runs the module for `after` more microseconds. Cuts the
/// power at the time when operation number `operation` would end, or at the end of the run if this operation
/// has not ended by then. Returns whether the module reported that `to` is stored.
bool cut(FlashChip& chip, const Settings& to, std::uint64_t after, std::size_t operation, const Tear& tear) {
  bool saved = false;
  try {
    chip.cut(operation, tear);
    OnFlash module(chip);
    module.idle(2'000);
    saved = module.save(to);
    module.idle(after);
    chip.power_off(tear);
  } catch (const PowerFailure&) {
  }
  return saved;
}

TEST(FlashSettingsCuts, ACutAtAnyOperationLeavesTheOldOrTheNewSettings) {
  constexpr std::uint64_t kAfter = 60'000;
  std::size_t cuts = 0;
  std::size_t cuts_of_erases = 0;
  for (const Beginning& beginning : beginnings()) {
    FlashChip whole = beginning.chip;
    {
      OnFlash module(whole);
      module.idle(2'000);
      ASSERT_TRUE(module.save(numbered(200)));
      module.idle(kAfter);
    }
    for (std::size_t i = beginning.chip.earliest_open(); i < whole.operations().size(); ++i) {
      for (const Tear& tear : tears(whole.operations()[i])) {
        FlashChip chip = beginning.chip;
        const bool saved = cut(chip, numbered(200), kAfter, i, tear);
        ++cuts;
        cuts_of_erases += whole.operations()[i] == FlashChip::Operation::Erase ? 1 : 0;
        OnFlash next(chip);
        ASSERT_FALSE(next.keeper().unreadable()) << beginning.what;
        ASSERT_TRUE(next.stored() == numbered(200) || (!saved && next.stored() == beginning.settings))
            << beginning.what << ", operation " << i << ", tear " << static_cast<int>(tear.kind)
            << ", prefix " << tear.prefix << ", seed " << tear.seed;
        next.settle();
        ASSERT_TRUE(next.save(numbered(4000)));
        ASSERT_TRUE(OnFlash(chip).stored() == numbered(4000));
      }
    }
  }
  EXPECT_GT(cuts_of_erases, 0U);
  std::printf("power cuts: %zu, %zu of them during erases\n", cuts, cuts_of_erases);
}

// Tests a random sample of the pairs of cuts, with a fixed seed.
TEST(FlashSettingsCuts, TwoSuccessiveCutsLeaveTheOldOrTheNewSettings) {
  constexpr int kPairs = 300;
  std::mt19937 random(kSeed);
  for (const Beginning& beginning : beginnings()) {
    for (int pair = 0; pair < kPairs; ++pair) {
      FlashChip chip = beginning.chip;
      std::vector<Settings> possible{beginning.settings};
      for (const unsigned number : {200U, 300U}) {
        const Tear tear{Tear::kEveryKind[random() % 5], random() % (hal::flash::kEntrySize + 1),
                        static_cast<unsigned>(random())};
        const std::size_t operation = chip.operations().size() + random() % 10;
        if (cut(chip, numbered(number), random() % 60'000, operation, tear)) {
          possible.clear();
        }
        possible.push_back(numbered(number));
        const Settings found = OnFlash(chip).stored();
        ASSERT_NE(std::find(possible.begin(), possible.end(), found), possible.end())
            << beginning.what << ", pair " << pair << " (seed " << kSeed << ")";
      }
      OnFlash next(chip);
      next.settle();
      ASSERT_TRUE(next.save(numbered(4000)));
      ASSERT_TRUE(OnFlash(chip).stored() == numbered(4000));
    }
  }
}

TEST(FlashSettingsTime, SavesWithPausesOfAbout50MsDoNotWaitForAnErase) {
  for (Beginning& beginning : beginnings()) {
    beginning.chip.times = FlashChip::kLongest;
    OnFlash module(beginning.chip);
    std::uint64_t longest = 0;
    for (unsigned i = 0; i < 400; ++i) {
      ASSERT_TRUE(module.save(numbered(i))) << beginning.what;
      longest = std::max(longest, module.latency);
      module.idle(48'000 + i * 331 % 4'000);
    }
    EXPECT_GT(beginning.chip.suspensions, 5U) << beginning.what;
    EXPECT_LE(longest, 60'000U);
    std::printf("erase 400 ms, program 3 ms, %s: longest save %.1f ms\n", beginning.what,
                static_cast<double>(longest) / 1e3);
  }
}

TEST(FlashSettingsTime, SavesAndLoadsThatCannotSucceedFailInTime) {
  std::vector<std::pair<std::string, std::uint64_t>> longest;
  for (Beginning& beginning : beginnings()) {
    beginning.chip.times = {1'000'000'000, 3'000};  // an erase that begins later does not end in this test
    OnFlash module(beginning.chip);
    unsigned saves = 0;
    while (module.save(numbered(saves))) {
      ASSERT_LT(++saves, 10'000U);
    }
    EXPECT_LE(module.latency, kReplyLimit - 20'000) << beginning.what;
    longest.emplace_back(beginning.what, module.latency);

    FlashChip dead = beginning.chip;
    dead.power_off({});
    OnFlash reader(dead);
    dead.hangs = true;
    EXPECT_FALSE(reader.save(numbered(1)));
    EXPECT_LE(reader.latency, kReplyLimit - 20'000) << beginning.what;
    longest.emplace_back("a dead flash", reader.latency);
    const std::uint64_t began = dead.now;
    EXPECT_TRUE(OnFlash(dead).keeper().unreadable());
    EXPECT_LE(dead.now - began, 90'000U) << "a module is ready to receive within 100 ms of a reset";
  }
  for (const auto& [what, time] : longest) {
    std::printf("refused after %.1f ms: %s\n", static_cast<double>(time) / 1e3, what.c_str());
  }
}

TEST(FlashSettingsTime, LoadingIsFastEvenIfAnEraseWasRunning) {
  for (const Beginning& beginning : beginnings()) {
    FlashChip chip = beginning.chip;
    chip.times = FlashChip::kLongest;
    OnFlash(chip).save(numbered(7));
    OnFlash(chip).idle(100'000);  // if a sector is free, its erase is running at the next reset
    const std::uint64_t began = chip.now;
    OnFlash next(chip);
    EXPECT_TRUE(next.stored() == numbered(7));
    EXPECT_LE(chip.now - began, 40'000U) << beginning.what;
  }
}

}  // namespace
}  // namespace ex9000
