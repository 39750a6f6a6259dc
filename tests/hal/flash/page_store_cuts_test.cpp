// Cuts the power at the program operations and the erases of the page store. After each cut, the page of the
// last write must have its new content, or its old content if the store has not reported success for this
// write. All other pages must be unchanged.
#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <vector>

#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

constexpr unsigned kSeed = 1;
constexpr unsigned kSeedsOfAKind = 8;

/// A chip, the store that runs on it, and the expected content of each page.
struct State {
  FlashChip chip;
  Store store;
  std::vector<Page> pages;
};

/// A write, and the pause after it.
struct Write {
  std::size_t page;
  unsigned content;
  std::uint64_t pause;  ///< us
};

/// Carries out `write` and the pause after it. Sets `reported` to whether the store reported success. Returns
/// whether the power is still on.
bool carry_out(State& state, const Write& write, bool& reported) {
  Session run(state.chip, state.store);
  reported = false;
  bool power = true;
  try {
    reported = run.write(write.page, numbered(write.content));
    run.run(write.pause);
  } catch (const PowerFailure&) {
    power = false;
  }
  state.store = run.store();
  return power;
}

std::vector<Tear> tears_of(FlashChip::Operation operation) {
  std::vector<Tear> tears;
  for (unsigned seed = 1; seed <= kSeedsOfAKind; ++seed) {
    for (const Tear::Kind kind : Tear::kEveryKind) {
      const std::size_t size = operation == FlashChip::Operation::Erase ? FlashChip::kSector : kEntrySize;
      tears.push_back({kind, size * seed / (kSeedsOfAKind + 1), kSeed * 100 + seed});
    }
  }
  if (operation == FlashChip::Operation::Program) {
    for (std::size_t prefix = 0; prefix <= kEntrySize; ++prefix) {
      tears.push_back({Tear::Kind::Prefix, prefix, kSeed});
    }
  }
  return tears;
}

class PageStoreCuts : public testing::Test {
 protected:
  void TearDown() override {
    std::printf("power cuts in %s: %zu\n", testing::UnitTest::GetInstance()->current_test_info()->name(),
                cuts_);
  }

  /// Carries out `write`. Cuts the power at the time when operation number `operation` would end, or after
  /// the pause if this operation has not ended by then. Then starts the store again, checks all pages, and
  /// puts the restarted store and the content of the pages into `state`.
  void cut(State& state, const Write& write, std::size_t operation, Tear tear) {
    state.chip.cut(operation, tear);
    bool reported = false;
    if (carry_out(state, write, reported)) {
      state.chip.power_off(tear);  // the selected operation has not ended
    }
    ++cuts_;
    Session next(state.chip);
    for (std::size_t page = 0; page < kPages; ++page) {
      const Page found = next.page(page);
      if (page == write.page && !reported && found != state.pages[page]) {
        state.pages[page] = numbered(write.content);
      } else if (page == write.page && reported) {
        state.pages[page] = numbered(write.content);
      }
      ASSERT_EQ(found, state.pages[page])
          << "page " << page << ", operation " << operation << ", tear " << static_cast<int>(tear.kind)
          << ", prefix " << tear.prefix << ", seed " << tear.seed;
    }
    state.store = next.store();
  }

  /// Checks that the store works, and that it keeps all pages.
  static void expect_works(State& state) {
    Session run(state.chip, state.store);
    run.settle();
    for (const unsigned content : {9001U, 9002U}) {
      const std::size_t page = content % 3;
      state.pages[page] = numbered(content);
      ASSERT_TRUE(run.write(page, numbered(content)));
    }
    Session next(state.chip);
    for (std::size_t page = 0; page < kPages; ++page) {
      ASSERT_EQ(next.page(page), state.pages[page]) << "page " << page;
    }
  }

  /// Cuts the power at each operation during `write` and the pause after it, including an erase that has
  /// begun before `write`. For each operation, tries the tears that `tears_of` returns; if `in_every_way` is
  /// false, tries only some of these tears. After each cut, checks the store. At the end, carries out `write`
  /// and the pause on `state`, without a cut.
  void cut_everywhere(State& state, const Write& write, bool in_every_way = true) {
    State whole = state;
    bool reported = false;
    carry_out(whole, write, reported);
    ASSERT_TRUE(reported);
    for (std::size_t i = state.chip.earliest_open(); i < whole.chip.operations().size(); ++i) {
      for (const Tear& tear : tears_of(whole.chip.operations()[i])) {
        if (!in_every_way && (tear.seed + tear.prefix) % 7 != 0) {
          continue;
        }
        State torn = state;
        cut(torn, write, i, tear);
        expect_works(torn);
        if (HasFatalFailure()) {
          return;
        }
      }
    }
    whole.pages[write.page] = numbered(write.content);
    state = whole;
  }

  static State blank() {
    State state;
    state.pages.assign(kPages, Page());
    for (Page& page : state.pages) {
      page.fill(0xFF);
    }
    return state;
  }
  static State settled(const FlashChip::Times& times = {}) {
    State state = blank();
    state.chip.times = times;
    Session run(state.chip);
    run.settle();
    state.store = run.store();
    return state;
  }
  static void write(State& state, const Write& write) {
    bool reported = false;
    ASSERT_TRUE(carry_out(state, write, reported) && reported);
    state.pages[write.page] = numbered(write.content);
  }
  /// Returns a state in which each of the pages 4 to 11 is in a different sector. Three slots are free in the
  /// sector that the store is writing.
  static State full() {
    State state = settled();
    unsigned content = 1;
    for (std::size_t page = 4; page < kPages; ++page) {
      write(state, {page, content++, 0});
      for (unsigned i = 0; i < kSlotsOfASector - 2; ++i) {
        write(state, {i % 4, content++, 0});
      }
    }
    for (unsigned i = 0; i < kSlotsOfASector - 4; ++i) {
      write(state, {i % 4, content++, 0});
    }
    return state;
  }

  std::size_t cuts_ = 0;
};

TEST_F(PageStoreCuts, ACutInTheFirstRunOnAFlashLeavesTheOldOrTheNewPage) {
  State state = blank();
  for (const unsigned content : {1U, 2U}) {
    // A write that begins before the first erase has ended may fail, so the store runs for 50 ms first.
    Session run(state.chip, state.store);
    run.run(50'000);
    state.store = run.store();
    cut_everywhere(state, {1, content, 300'000});
  }
}

TEST_F(PageStoreCuts, ACutAtTheFirstWritesAfterAResetLeavesTheOldOrTheNewPage) {
  State state = settled();
  write(state, {0, 1, 0});
  write(state, {1, 2, 0});
  Session run(state.chip);
  run.run(20'000);
  state.store = run.store();
  for (const Write& write : {Write{0, 3, 100'000}, {1, 4, 1'000}, {0, 5, 1'000}, {2, 6, 100'000}}) {
    cut_everywhere(state, write);
  }
}

TEST_F(PageStoreCuts, ACutAtTheEndOfASectorOrAtTheErasesAfterItLeavesTheOldOrTheNewPage) {
  State state = full();
  unsigned content = 5000;
  for (const unsigned pause : {1'000U, 3'000U, 3'000U, 10'000U, 60'000U, 3'000U, 100'000U}) {
    cut_everywhere(state, {content % 4, content, pause});
    ++content;
  }
}

TEST_F(PageStoreCuts, ACutWithTheLongestTimesOfTheFlashLeavesTheOldOrTheNewPage) {
  State state = full();
  state.chip.times = FlashChip::kLongest;
  unsigned content = 5000;
  for (const unsigned pause : {1'000U, 3'000U, 5'000U, 5'000U, 20'000U}) {
    cut_everywhere(state, {content % 4, content, pause}, false);
    ++content;
  }
}

// There are too many sequences of cuts to test them all, so this test uses a random sample with a fixed seed.
TEST_F(PageStoreCuts, SeveralSuccessiveCutsLeaveTheOldOrTheNewPage) {
  constexpr int kRounds = 100;
  constexpr int kCutsInARow = 6;
  std::mt19937 random(kSeed);
  for (State beginning : {blank(), settled(), full()}) {
    for (int round = 0; round < kRounds; ++round) {
      State state = beginning;
      for (int i = 0; i < kCutsInARow && !HasFatalFailure(); ++i) {
        const auto content = static_cast<unsigned>(random() % 100'000);
        const Write write{random() % 4, content, random() % 70'000};
        const std::size_t operation = state.chip.earliest_open() + random() % 6;
        cut(state, write, operation,
            {Tear::kEveryKind[random() % 5], random() % FlashChip::kSector % (1U + random() % 100U),
             static_cast<unsigned>(random())});
      }
      expect_works(state);
      if (HasFatalFailure()) {
        return;
      }
    }
  }
}

}  // namespace
}  // namespace ex9000::hal::flash
