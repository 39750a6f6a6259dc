// Tests power cuts during a save to a memory with a record of newer firmware, or with the bytes of a
// released firmware: wire.md section 8, "The power may fail at any time, also during a write."
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdio>
#include <random>
#include <vector>

#include "tests/firmware/settings/settings_store_bench.hpp"
#include "tests/firmware/settings/stored_bytes.hpp"

namespace ex9000 {
namespace {

constexpr unsigned kSeed = 1;

struct Beginning {
  const char* what;
  FakeMemory memory;
  Settings settings;
};

std::vector<Beginning> beginnings() {
  FakeMemory longer;
  put_longer(longer, 0, numbered(6), 8, 96);
  FakeMemory two_longer = longer;
  put_longer(two_longer, 1, numbered(5), 7, 120);
  return {{"a longer record", longer, numbered(6)}, {"two longer records", two_longer, numbered(6)}};
}

/// Returns the number of bytes that a module writes when it starts and saves `to`.
std::size_t bytes_of(FakeMemory memory, const Settings& to) {
  memory.bytes_written = 0;
  EXPECT_TRUE(Boot(memory).save(to));
  return memory.bytes_written;
}

/// Starts a module and saves `to`, with a power cut after `bytes` written bytes. Returns whether the store
/// reported success before the cut.
bool cut(FakeMemory& memory, const Settings& to, std::size_t bytes, FakeMemory::Garbage garbage) {
  memory.power = bytes;
  memory.garbage = garbage;
  const bool saved = Boot(memory).save(to);
  memory.power.reset();
  return saved;
}

TEST(LongerRecordCuts, ACutAtAnyPointOfAStoreLeavesTheOldOrTheNewSettings) {
  std::size_t cuts = 0;
  for (const Beginning& beginning : beginnings()) {
    const std::size_t bytes = bytes_of(beginning.memory, numbered(200));
    for (std::size_t at = 0; at <= bytes; ++at) {
      for (const FakeMemory::Garbage garbage : FakeMemory::kEveryGarbage) {
        FakeMemory memory = beginning.memory;
        const bool saved = cut(memory, numbered(200), at, garbage);
        ++cuts;
        const Settings found = Boot(memory).stored();
        ASSERT_TRUE(found == numbered(200) || (!saved && found == beginning.settings))
            << beginning.what << ", cut after byte " << at;
        ASSERT_NE(found.address, 1) << "the module uses the factory address";
        ASSERT_TRUE(Boot(memory).save(numbered(4000)));
        ASSERT_TRUE(Boot(memory).stored() == numbered(4000));
      }
    }
  }
  std::printf("power cuts: %zu\n", cuts);
}

// The number of pairs of cuts grows with the square of the number of written bytes, so this test uses a
// random sample with a fixed seed.
TEST(LongerRecordCuts, TwoCutsInARowLeaveTheOldOrTheNewSettings) {
  constexpr int kPairs = 4000;
  std::mt19937 random(kSeed);
  for (const Beginning& beginning : beginnings()) {
    const std::size_t bytes = bytes_of(beginning.memory, numbered(200));
    for (int pair = 0; pair < kPairs; ++pair) {
      FakeMemory memory = beginning.memory;
      const auto garbage = [&random] { return FakeMemory::kEveryGarbage[random() % 5]; };
      const std::size_t first = random() % (bytes + 1);
      const std::size_t second = random() % (bytes + 1);
      const bool saved = cut(memory, numbered(200), first, garbage());
      const Settings between = Boot(memory).stored();
      ASSERT_TRUE(between == numbered(200) || (!saved && between == beginning.settings));
      const bool saved_again = cut(memory, numbered(300), second, garbage());
      const Settings found = Boot(memory).stored();
      // If the power fails in two successive stores, the module may use the settings of the first of them
      // (wire.md section 8).
      ASSERT_TRUE(found == numbered(300) || (!saved_again && (found == between || found == numbered(200))))
          << beginning.what << ", cut after byte " << first << ", then " << second << " (seed " << kSeed
          << ")";
      ASSERT_TRUE(Boot(memory).save(numbered(4000)));
      ASSERT_TRUE(Boot(memory).stored() == numbered(4000));
    }
  }
}

// Each file in stored_bytes/ contains a memory after a store of released firmware. The test saves changed
// settings to this memory once for each number of written bytes, and the power fails after this number.
TEST(LongerRecordCuts, ACutWithStoredBytesLeavesTheOldOrTheNewSettings) {
  for (const StoredBytes& stored : all_stored_bytes()) {
    Settings changed = stored.settings;
    changed.watchdog_timeout = 0x77;
    FakeMemory whole;
    whole.cells = stored.memory;
    ASSERT_TRUE(Boot(whole, *stored.model).save(changed));
    for (std::size_t at = 0; at <= whole.bytes_written; ++at) {
      FakeMemory memory;
      memory.cells = stored.memory;
      memory.power = at;
      memory.garbage = FakeMemory::Garbage::MixedWithOld;
      Boot(memory, *stored.model).save(changed);
      memory.power.reset();
      const Settings found = Boot(memory, *stored.model).stored();
      EXPECT_TRUE(found == stored.settings || found == changed) << stored.file << ", cut after byte " << at;
    }
  }
}

}  // namespace
}  // namespace ex9000
