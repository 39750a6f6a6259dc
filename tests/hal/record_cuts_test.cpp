// Cuts the power at every point of a save, in an EEPROM and in a flash. After each cut, the module must load
// the old or the new settings, or the new ones if the save has succeeded, and must be able to save:
// wire.md section 8, "The power may fail at any time, also during a write."
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "tests/firmware/settings/stored_bytes.hpp"
#include "tests/hal/eeprom/two_places_bench.hpp"
#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000 {
namespace {

using hal::flash::FlashChip;
using hal::flash::OnFlash;
using hal::flash::Tear;

constexpr unsigned kSeed = 1;

/// The content of a memory before a save, and the settings in it.
template <class Medium>
struct Beginning {
  std::string what;
  Medium medium;
  Settings settings;
  const Model* model = &the_model();
};

struct Attempt {
  bool saved = false;
  bool power_failed = false;
};

// Both harnesses have the same members:
//
//     Medium                  the memory without the module
//     Cut                     a moment at which the power fails, and what it leaves
//     beginnings()            different contents
//     cuts(medium, model, to) all cuts of a save of `to`, including the work after it
//     any_cut(medium, random) one of the cuts of a save, or one shortly after it
//     save(medium, model, to, cut)
//                             starts a module and saves `to` with this cut; returns whether the save
//                             succeeded
//     failures()              functions that make a save fail, each in a different way
//     fail_and_cut(medium, model, to, fail, point)
//                             starts a module, makes it fail, saves `to`, and cuts the power at this point of
//                             the save, if the save has so many
//     Run                     a module from one reset to the next, with `save` and `stored`

struct Eeprom {
  using Medium = FakeEeprom;
  using Run = Boot;
  struct Cut {
    std::size_t bytes;  ///< written before the power fails
    FakeEeprom::Garbage garbage;
  };

  static std::vector<Beginning<Medium>> beginnings() {
    FakeEeprom one;
    put(one, 0, numbered(100), 1);
    FakeEeprom two = one;
    put(two, 1, numbered(101), 2);
    FakeEeprom other_way = two;
    put(other_way, 0, numbered(102), 3);
    FakeEeprom longer;
    put_longer(longer, 0, numbered(6), 8, 96);
    FakeEeprom two_longer = longer;
    put_longer(two_longer, 1, numbered(5), 7, 120);
    std::vector<Beginning<Medium>> all{{"blank", {}, factory()},
                                       {"one copy", one, numbered(100)},
                                       {"two copies", two, numbered(101)},
                                       {"the newer copy first", other_way, numbered(102)},
                                       {"a longer record", longer, numbered(6)},
                                       {"two longer records", two_longer, numbered(6)}};
    for (const StoredBytes& stored : all_stored_bytes()) {
      all.push_back({stored.file, {}, stored.settings, stored.model});
      all.back().medium.cells = stored.memory;
    }
    return all;
  }
  static std::vector<Cut> cuts(Medium medium, const Model& model, const Settings& to) {
    medium.bytes_written = 0;
    EXPECT_TRUE(Boot(medium, model).save(to));
    std::vector<Cut> all;
    for (std::size_t bytes = 0; bytes <= medium.bytes_written; ++bytes) {
      for (const FakeEeprom::Garbage garbage : FakeEeprom::kEveryGarbage) {
        all.push_back({bytes, garbage});
      }
    }
    return all;
  }
  static Cut any_cut(const Medium& /*medium*/, std::mt19937& random) {
    return {random() % 110, FakeEeprom::kEveryGarbage[random() % 5]};
  }
  static bool save(Medium& medium, const Model& model, const Settings& to, const Cut& cut) {
    Boot run(medium, model);
    medium.power = cut.bytes;
    medium.garbage = cut.garbage;
    const bool saved = run.save(to);
    repair(medium);
    return saved;
  }
  static const std::vector<void (*)(Medium&)>& failures() { return kFailures; }
  static Attempt fail_and_cut(Medium& medium, const Model& model, const Settings& to, void (*fail)(Medium&),
                              std::size_t point) {
    Boot run(medium, model);
    fail(medium);
    medium.power = point;
    medium.garbage = FakeEeprom::Garbage::MixedWithOld;
    Attempt attempt;
    attempt.saved = run.save(to);
    attempt.power_failed = medium.power == 0;
    repair(medium);
    return attempt;
  }
  static void repair(Medium& medium) {
    medium.power.reset();
    medium.failing_reads = medium.noisy_reads = medium.unanswered_writes = 0;
    medium.unanswered_but_done = medium.stuck = false;
  }
};

struct Flash {
  using Medium = FlashChip;
  struct Cut {
    std::size_t operation;  ///< number of the operation at whose end the power fails; see FlashChip::cut
    Tear tear;
    std::uint64_t after = 60'000;  ///< the power fails at the latest this many us after the save
  };
  /// A module that erases the free sectors before it saves.
  class Run : public OnFlash {
   public:
    using OnFlash::OnFlash;
    bool save(const Settings& settings) {
      settle();
      return OnFlash::save(settings);
    }
  };

  /// Returns a chip with `saves` saves of numbered(first) and later, without a reset between them.
  static Beginning<Medium> after_saves(const char* what, unsigned first, unsigned saves) {
    Beginning<Medium> beginning{what, hal::flash::settled(), factory()};
    OnFlash module(beginning.medium);
    for (unsigned i = 0; i < saves; ++i) {
      beginning.settings = numbered(first + i);
      EXPECT_TRUE(module.save(beginning.settings));
    }
    return beginning;
  }
  static std::vector<Beginning<Medium>> beginnings() {
    std::vector<Beginning<Medium>> all{
        {"never used", {}, factory()},
        after_saves("blank", 0, 0),
        after_saves("one record", 100, 1),
        after_saves("the end of a sector", 100, hal::flash::kPlacesOfASector - 1),
        after_saves("many saves", 1000, 200)};
    Beginning<Medium> erasing = after_saves("an erase", 100, 1);
    EXPECT_TRUE(OnFlash(erasing.medium).save(numbered(200)));
    OnFlash(erasing.medium).idle(20'000);
    all.push_back({"an erase", erasing.medium, numbered(200)});
    return all;
  }
  static std::vector<Tear> tears(FlashChip::Operation operation) {
    constexpr std::size_t kRecordSize = 27;
    const bool erase = operation == FlashChip::Operation::Erase;
    std::vector<Tear> all;
    for (unsigned seed = 1; seed <= 5; ++seed) {
      for (const Tear::Kind kind : Tear::kEveryKind) {
        all.push_back({kind, (erase ? FlashChip::kSector : kRecordSize) * seed / 6, seed});
      }
    }
    for (std::size_t prefix = 0; !erase && prefix <= kRecordSize; ++prefix) {
      all.push_back({Tear::Kind::Prefix, prefix, 1});
    }
    return all;
  }
  static std::vector<Cut> cuts(Medium medium, const Model& model, const Settings& to) {
    std::vector<Cut> all;
    const std::size_t first = medium.earliest_open();
    save(medium, model, to, {SIZE_MAX, {}});
    for (std::size_t operation = first; operation < medium.operations().size(); ++operation) {
      for (const Tear& tear : tears(medium.operations()[operation])) {
        all.push_back({operation, tear});
      }
    }
    return all;
  }
  static Cut any_cut(const Medium& medium, std::mt19937& random) {
    const Tear tear{Tear::kEveryKind[random() % 5], random() % FlashChip::kSector % (1U + random() % 100U),
                    static_cast<unsigned>(random())};
    return {medium.earliest_open() + random() % 8, tear, random() % 60'000};
  }
  static bool save(Medium& medium, const Model& model, const Settings& to, const Cut& cut) {
    bool saved = false;
    try {
      medium.cut(cut.operation, cut.tear);
      OnFlash module(medium, model);
      module.idle(60'000);  // the first save of a new flash waits for an erase
      saved = module.save(to);
      module.idle(cut.after);
      medium.power_off(cut.tear);
    } catch (const hal::flash::PowerFailure&) {
    }
    return saved;
  }
  static std::vector<void (*)(Medium&)> failures() {
    return {[](Medium& medium) { medium.noisy_reads = kAttempts; }, [](Medium& medium) { wear(medium, 0); },
            [](Medium& medium) { wear(medium, 8); }, [](Medium& medium) { wear(medium, 24); }};
  }
  /// Makes a byte of every place keep its value.
  static void wear(Medium& medium, std::size_t at) {
    medium.broken = at;
    medium.broken_every = kRecordRoom;
    medium.broken_keeps = true;
  }
  static Attempt fail_and_cut(Medium& medium, const Model& model, const Settings& to, void (*fail)(Medium&),
                              std::size_t point) {
    OnFlash module(medium, model);
    module.settle();
    fail(medium);
    medium.cut(medium.operations().size() + point, {Tear::Kind::Garbage, 9, kSeed});
    Attempt attempt;
    try {
      attempt.saved = module.save(to);
      medium.power_off({});
    } catch (const hal::flash::PowerFailure&) {
      attempt.power_failed = true;
    }
    medium.broken = SIZE_MAX;
    medium.noisy_reads = 0;
    return attempt;
  }
};

template <class Harness>
class RecordCuts : public testing::Test {
 protected:
  using Medium = typename Harness::Medium;
  using Cut = typename Harness::Cut;
  using Run = typename Harness::Run;

  void TearDown() override {
    std::printf("power cuts in %s: %zu\n", testing::UnitTest::GetInstance()->current_test_info()->name(),
                cuts_);
  }

  /// Returns settings that `beginning` does not hold. Only one value differs, so that they fit every model.
  static Settings changed(const Beginning<Medium>& beginning, std::uint8_t timeout) {
    Settings settings = beginning.settings;
    settings.watchdog_timeout = timeout;
    return settings;
  }

  /// Saves `to` with a cut. Checks that the next reset finds one of `before`, or `to`, and replaces `before`
  /// by what it may find after another cut.
  void cut(Medium& medium, const Model& model, const Settings& to, const Cut& cut,
           std::vector<Settings>& before) {
    const bool saved = Harness::save(medium, model, to, cut);
    ++cuts_;
    if (saved) {
      before.clear();
    }
    before.push_back(to);
    ASSERT_NE(std::find(before.begin(), before.end(), Run(medium, model).stored()), before.end());
  }

  static void expect_works(Medium& medium, const Model& model, const Settings& settings) {
    ASSERT_TRUE(Run(medium, model).save(settings));
    ASSERT_TRUE(Run(medium, model).stored() == settings);
  }

  std::size_t cuts_ = 0;
};

using Harnesses = testing::Types<Eeprom, Flash>;
TYPED_TEST_SUITE(RecordCuts, Harnesses);

TYPED_TEST(RecordCuts, ACutAtAnyPointOfASaveLeavesTheOldOrTheNewSettings) {
  for (const auto& beginning : TypeParam::beginnings()) {
    const Settings to = this->changed(beginning, 0x77);
    for (const auto& cut : TypeParam::cuts(beginning.medium, *beginning.model, to)) {
      auto medium = beginning.medium;
      std::vector<Settings> before{beginning.settings};
      this->cut(medium, *beginning.model, to, cut, before);
      this->expect_works(medium, *beginning.model, this->changed(beginning, 0x88));
      ASSERT_FALSE(this->HasFailure()) << beginning.what;
    }
  }
}

// There are too many sequences of cuts to test them all, so this test uses a random sample with a fixed seed.
TYPED_TEST(RecordCuts, SeveralCutsInARowLeaveOneOfTheirSettings) {
  constexpr int kRounds = 200;
  constexpr std::uint8_t kCutsInARow = 6;
  std::mt19937 random(kSeed);
  for (const auto& beginning : TypeParam::beginnings()) {
    for (int round = 0; round < kRounds; ++round) {
      auto medium = beginning.medium;
      std::vector<Settings> before{beginning.settings};
      for (std::uint8_t i = 1; i <= kCutsInARow; ++i) {
        this->cut(medium, *beginning.model, this->changed(beginning, i), TypeParam::any_cut(medium, random),
                  before);
      }
      this->expect_works(medium, *beginning.model, this->changed(beginning, 0x88));
      ASSERT_FALSE(this->HasFailure()) << beginning.what << ", round " << round;
    }
  }
}

TYPED_TEST(RecordCuts, ACutAtAnyPointOfAFailingSaveLeavesTheOldOrTheNewSettings) {
  for (const auto& beginning : TypeParam::beginnings()) {
    for (const auto fail : TypeParam::failures()) {
      const Settings to = this->changed(beginning, 0x77);
      bool power_failed = true;
      for (std::size_t point = 0; power_failed; ++point) {
        auto medium = beginning.medium;
        const Attempt attempt = TypeParam::fail_and_cut(medium, *beginning.model, to, fail, point);
        power_failed = attempt.power_failed;
        this->cuts_ += power_failed ? 1 : 0;
        const Settings found = typename TypeParam::Run(medium, *beginning.model).stored();
        ASSERT_TRUE(attempt.saved ? found == to
                                  : found == beginning.settings || (power_failed && found == to))
            << beginning.what << ", point " << point;
        this->expect_works(medium, *beginning.model, this->changed(beginning, 0x88));
      }
    }
  }
}

}  // namespace
}  // namespace ex9000
