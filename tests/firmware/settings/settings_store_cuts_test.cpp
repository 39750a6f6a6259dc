// Tests power cuts while the settings are saved: wire.md section 8, "The power may fail at any time, also
// during a write."
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdio>
#include <iterator>
#include <optional>
#include <vector>

#include "tests/firmware/settings/settings_store_bench.hpp"

namespace ex9000 {
namespace {

constexpr std::size_t kBytesOfARecord = 27;

class PowerCuts : public testing::Test {
 protected:
  static std::vector<FakeMemory> beginnings() {
    FakeMemory blank;
    FakeMemory one_copy;
    EXPECT_TRUE(Boot(one_copy).save(numbered(100)));
    FakeMemory two_copies = one_copy;
    EXPECT_TRUE(Boot(two_copies).save(numbered(101)));
    FakeMemory two_copies_the_other_way = two_copies;
    EXPECT_TRUE(Boot(two_copies_the_other_way).save(numbered(102)));
    return {blank, one_copy, two_copies, two_copies_the_other_way};
  }

  /// Returns the number of bytes that a complete save writes.
  static std::size_t bytes_of_a_save(FakeMemory memory, const Settings& to) {
    Boot run(memory);
    memory.bytes_written = 0;
    run.save(to);
    return memory.bytes_written;
  }

  /// Saves `to` with a power cut after `bytes` bytes, and returns the settings that the next load finds.
  /// Expects that these are either the previous settings or `to`.
  Settings cut_and_load(FakeMemory& memory, const Settings& to, std::size_t bytes,
                        FakeMemory::Garbage garbage) {
    Boot run(memory);
    const Settings before = run.stored();
    memory.power = bytes;
    memory.garbage = garbage;
    EXPECT_FALSE(run.save(to)) << "no cut after " << bytes << " bytes";
    ++cuts_;
    with_power(memory);
    const Boot next(memory);
    EXPECT_TRUE(next.stored() == before || next.stored() == to) << "cut after " << bytes << " bytes";
    return next.stored();
  }

  static void with_power(FakeMemory& memory) {
    memory.power.reset();
    memory.failing_reads = memory.noisy_reads = memory.unanswered_writes = 0;
  }

  static void expect_works(FakeMemory& memory) {
    ASSERT_TRUE(Boot(memory).save(numbered(4000)));
    ASSERT_TRUE(Boot(memory).stored() == numbered(4000));
  }

  void TearDown() override {
    std::printf("power cuts in %s: %zu\n", testing::UnitTest::GetInstance()->current_test_info()->name(),
                cuts_);
  }

  std::size_t cuts_ = 0;
};

TEST_F(PowerCuts, ACutAtAnyByteOfASaveLeavesTheOldOrTheNewSettings) {
  for (const FakeMemory& beginning : beginnings()) {
    const std::size_t bytes = bytes_of_a_save(beginning, numbered(200));
    for (std::size_t cut = 0; cut <= bytes; ++cut) {
      for (const FakeMemory::Garbage garbage : FakeMemory::kEveryGarbage) {
        FakeMemory memory = beginning;
        cut_and_load(memory, numbered(200), cut, garbage);
        expect_works(memory);
      }
    }
  }
}

TEST_F(PowerCuts, ACutAfterTheLastByteLeavesTheNewSettings) {
  for (const FakeMemory& beginning : beginnings()) {
    FakeMemory memory = beginning;
    const std::size_t bytes = bytes_of_a_save(beginning, numbered(200));
    EXPECT_TRUE(cut_and_load(memory, numbered(200), bytes, FakeMemory::Garbage::None) == numbered(200));
  }
}

TEST_F(PowerCuts, ACutAfterASuccessfulSaveLeavesTheNewSettings) {
  for (const FakeMemory& beginning : beginnings()) {
    FakeMemory memory = beginning;
    ASSERT_TRUE(Boot(memory).save(numbered(200)));
    ++cuts_;
    EXPECT_TRUE(Boot(memory).stored() == numbered(200));
  }
}

TEST_F(PowerCuts, ACutAtAnyByteOfAFailingSaveLeavesTheOldOrTheNewSettings) {
  for (const FakeMemory& beginning : beginnings()) {
    for (const auto fail : kFailures) {
      const auto failing = [&] {
        FakeMemory memory = beginning;
        fail(memory);
        return memory;
      };
      // Only the save fails; the load before the save succeeds.
      const auto cut_at = [&](std::optional<std::size_t> cut) {
        FakeMemory memory = beginning;
        Boot run(memory);
        const Settings before = run.stored();
        memory = failing();
        memory.bytes_written = 0;
        memory.power = cut;
        memory.garbage = FakeMemory::Garbage::MixedWithOld;
        const bool saved = run.save(numbered(200));
        const std::size_t bytes = memory.bytes_written;
        with_power(memory);
        const Settings found = Boot(memory).stored();
        EXPECT_TRUE(found == numbered(200) || (!saved && found == before))
            << "bytes before the cut, or 0 without a cut: " << cut.value_or(0);
        memory.stuck = false;
        expect_works(memory);
        return bytes;
      };
      const std::size_t bytes = cut_at(std::nullopt);
      for (std::size_t cut = 0; cut <= bytes; ++cut) {
        cut_at(cut);
        ++cuts_;
      }
    }
  }
}

TEST_F(PowerCuts, TwoConsecutiveCutsLeaveTheOldOrTheNewSettings) {
  for (const FakeMemory& beginning : beginnings()) {
    const std::size_t bytes = bytes_of_a_save(beginning, numbered(200));
    for (std::size_t first = 0; first <= bytes; ++first) {
      for (const FakeMemory::Garbage garbage : FakeMemory::kEveryGarbage) {
        FakeMemory once = beginning;
        const Settings between = cut_and_load(once, numbered(200), first, garbage);
        for (std::size_t second = 0; second <= bytes; ++second) {
          FakeMemory twice = once;
          const Settings found = cut_and_load(twice, numbered(300), second, garbage);
          EXPECT_TRUE(found == between || found == numbered(300));
          expect_works(twice);
        }
      }
    }
  }
}

TEST_F(PowerCuts, ManyConsecutiveCutsLeaveTheOldOrTheNewSettings) {
  for (FakeMemory memory : beginnings()) {
    for (unsigned i = 0; i < 1000; ++i) {
      const std::size_t cut = (i * 7) % (kBytesOfARecord + 1);
      const auto garbage = FakeMemory::kEveryGarbage[i % std::size(FakeMemory::kEveryGarbage)];
      cut_and_load(memory, numbered(200 + i), cut, garbage);
    }
    expect_works(memory);
  }
}

}  // namespace
}  // namespace ex9000
