// What transcripts cannot reach: slow and failing flashes, and long images. Transcripts: modbus/update.
#include "firmware/update/update.hpp"

#include <gtest/gtest.h>

#include "tests/firmware/update/update_bench.hpp"

namespace ex9000::update {
namespace {

constexpr Duration kLongestWait = milliseconds(400);

TEST(Update, ContinuesAtTheBeginningOfTheSectorThatWasBeingWritten) {
  const Buffer image = image_of(3 * kSector + 100);
  for (const auto& [sent, continues] : {std::pair(0U, 0U),
                                        {kSector - kBlockSize, 0U},
                                        {kSector, kSector},
                                        {2 * kSector + kBlockSize, 2 * kSector},
                                        {3 * kSector, 3 * kSector}}) {
    Bench bench;
    EXPECT_EQ(bench.begin(image), Refusal::None);
    EXPECT_EQ(bench.blocks(image, sent), Refusal::None);
    bench.reset();
    EXPECT_EQ(bench.update().state(), continues == 0 ? State::None : State::Receiving);
    EXPECT_EQ(bench.update().next(), continues) << sent;
    // What was there of that sector does not matter.
    std::fill_n(bench.spare().begin() + kImageAt + continues, kSector, 0x00);
    EXPECT_EQ(bench.begin(image), Refusal::None);
    EXPECT_EQ(bench.update().next(), continues);
    EXPECT_EQ(bench.blocks(image), Refusal::None);
    EXPECT_EQ(bench.update().state(), State::Complete);
    EXPECT_EQ(bench.ask(Ask::Activate), Refusal::None);
    bench.reset();
    EXPECT_EQ(bench.running(), 1U);
    EXPECT_EQ(bench.update().state(), State::Unconfirmed);
  }
}

TEST(Update, AMarkOfASectorThatHasDecayedChangesNothingIfALaterOneIsSet) {
  const Buffer image = image_of(3 * kSector);
  Bench bench;
  bench.begin(image);
  bench.blocks(image, 2 * kSector);
  bench.spare()[kMarksAt] = 0x55;
  bench.reset();
  EXPECT_EQ(bench.update().state(), State::Receiving);
  EXPECT_EQ(bench.update().next(), 2 * kSector);
  EXPECT_EQ(bench.blocks(image), Refusal::None);
  EXPECT_EQ(bench.update().state(), State::Complete);
}

TEST(Update, ReceivesTheLongestImage) {
  const Buffer image = image_of(kLargestImage);
  Bench bench;
  EXPECT_EQ(bench.begin(image), Refusal::None);
  EXPECT_EQ(bench.blocks(image), Refusal::None);
  EXPECT_EQ(bench.update().state(), State::Complete);
  EXPECT_TRUE(std::equal(image.begin(), image.end(), bench.spare().begin() + kImageAt));
}

TEST(Update, ABlockThatAnEraseKeepsWaitingIsRefusedAfter400MsAndFoundDoneLater) {
  const Buffer image = image_of(200);
  Bench bench;
  EXPECT_EQ(bench.begin(image), Refusal::None);
  bench.holds = true;
  bench.block(image, 0);
  EXPECT_FALSE(bench.update().answered());
  bench.now = bench.now + kLongestWait - Duration(1);
  bench.run();
  EXPECT_FALSE(bench.update().answered());
  EXPECT_TRUE(bench.update().latest_answer().armed());
  bench.now = bench.now + Duration(1);
  bench.run();
  EXPECT_TRUE(bench.update().answered());
  EXPECT_EQ(bench.update().answer(), Refusal::UpdateRefused);
  EXPECT_FALSE(bench.update().latest_answer().armed());
  // The same block waits again, for the same erase.
  bench.block(image, 0);
  EXPECT_FALSE(bench.update().answered());
  bench.holds = false;
  bench.run();
  EXPECT_EQ(bench.update().answer(), Refusal::None);
  EXPECT_EQ(bench.update().next(), kBlockSize);
}

TEST(Update, ABlockIsRefusedWhileAnEarlierRequestStillNeedsTheBuffer) {
  const Buffer image = image_of(200);
  for (const bool compares : {false, true}) {
    Bench bench;
    EXPECT_EQ(bench.begin(image), Refusal::None);
    if (compares) {
      EXPECT_EQ(bench.block(image, 0), Refusal::None);
    }
    bench.holds = true;
    bench.block(image, 0);
    if (!compares) {
      bench.end_job();  // the erase
      bench.run();
    }
    bench.now = bench.now + kLongestWait;
    bench.run();
    EXPECT_EQ(bench.block(image, 0), Refusal::UpdateRefused);
    bench.holds = false;
    bench.run();
    EXPECT_EQ(bench.block(image, 0), Refusal::None);
    EXPECT_EQ(bench.update().next(), kBlockSize);
  }
}

TEST(Update, ABeginDuringAnyJobOfTheImageBeforeStartsAnew) {
  const Buffer old = image_of(2 * kSector, 9);
  const Buffer image = image_of(300);
  for (unsigned jobs = 0;; ++jobs) {
    Bench bench;
    EXPECT_EQ(bench.begin(old), Refusal::None);
    EXPECT_EQ(bench.blocks(old, kSector - kBlockSize), Refusal::None);
    bench.holds = true;
    bench.block(old, kSector - kBlockSize);
    for (unsigned i = 0; i < jobs && bench.update().busy(); ++i) {
      bench.end_job();
      bench.update().poll(bench.now);
    }
    const bool ended = !bench.update().busy();
    bench.now = bench.now + kLongestWait;
    bench.run();
    EXPECT_EQ(bench.begin(image), Refusal::None);
    bench.holds = false;
    bench.run();
    EXPECT_EQ(bench.update().state(), State::Receiving);
    EXPECT_EQ(bench.update().next(), 0U);
    EXPECT_EQ(bench.blocks(image), Refusal::None);
    EXPECT_EQ(bench.update().state(), State::Complete) << jobs;
    if (ended) {
      EXPECT_GE(jobs, 4U);
      break;
    }
  }
}

TEST(Update, AFlashThatDoesNotKeepWhatIsProgrammedFailsUntilTheNextBegin) {
  const Buffer image = image_of(kSector + 10);
  const auto expect_failure = [&image](Bench& bench, Refusal refusal) {
    EXPECT_EQ(refusal, Refusal::UpdateRefused);
    EXPECT_EQ(bench.update().state(), State::FlashFailed);
    EXPECT_EQ(bench.block(image, 0), Refusal::UpdateRefused);
    EXPECT_EQ(bench.ask(Ask::Activate), Refusal::UpdateRefused);
    bench.fails = false;
    EXPECT_EQ(bench.begin(image), Refusal::None);
    EXPECT_EQ(bench.blocks(image), Refusal::None);
    EXPECT_EQ(bench.update().state(), State::Complete);
  };
  for (const std::uint32_t before : {0U, kBlockSize, kSector - kBlockSize, kSector}) {
    Bench bench;
    bench.begin(image);
    bench.blocks(image, before);
    bench.fails = true;
    expect_failure(bench, bench.block(image, before));
  }
  Bench bench;
  bench.begin(image);
  bench.blocks(image);
  bench.fails = true;
  expect_failure(bench, bench.ask(Ask::Activate));
  // The header.
  Bench header;
  header.fails = true;
  header.begin(image);
  expect_failure(header, header.block(image, 0));
  // The mark of the running image: the other one stays.
  Bench unsecured;
  unsecured.slots().cells[1] = unsecured.slots().cells[0];
  unsecured.slots().cells[0][kMarksAt + kConfirmed] = 0x55;
  unsecured.reset();
  ASSERT_EQ(unsecured.running(), 1U);
  unsecured.slots().cells[1][kMarksAt + kConfirmed] = 0x55;  // the mark decays
  unsecured.fails = true;
  const Buffer other = unsecured.slots().cells[0];
  unsecured.begin(image);
  EXPECT_EQ(unsecured.slots().cells[0], other);
  expect_failure(unsecured, unsecured.block(image, 0));
  // A header that cannot be withdrawn.
  Bench abandoned;
  abandoned.begin(image);
  abandoned.fails = true;
  expect_failure(abandoned, abandoned.ask(Ask::Abandon));
}

TEST(Update, AMarkOfASectorThatIsNotKeptFails) {
  const Buffer image = image_of(kSector);
  Bench bench;
  bench.begin(image);
  bench.blocks(image, kSector - kBlockSize);
  bench.holds = true;
  bench.block(image, kSector - kBlockSize);
  bench.end_job();  // programs the block
  bench.end_job();  // reads it back
  bench.holds = false;
  bench.fails = true;
  bench.run();
  EXPECT_EQ(bench.update().answer(), Refusal::UpdateRefused);
  EXPECT_EQ(bench.update().state(), State::FlashFailed);
}

TEST(Update, AConfirmationThatIsNotKeptLeavesTheImageAndIsTriedAgain) {
  const Buffer image = image_of(100);
  Bench bench;
  bench.begin(image);
  bench.blocks(image);
  bench.ask(Ask::Activate);
  bench.reset();
  ASSERT_EQ(bench.update().state(), State::Unconfirmed);
  bench.fails = true;
  EXPECT_EQ(bench.ask(Ask::Confirm), Refusal::UpdateRefused);
  bench.update().proved();
  const unsigned jobs = bench.jobs;
  bench.run();
  EXPECT_EQ(bench.jobs, jobs + 2) << "it must not try again at once";
  EXPECT_EQ(bench.update().state(), State::Unconfirmed);
  bench.fails = false;
  bench.update().proved();
  bench.run();
  EXPECT_EQ(bench.update().state(), State::None);
  bench.reset();
  EXPECT_EQ(bench.running(), 1U);
  EXPECT_EQ(bench.update().state(), State::None);
}

TEST(Update, AFlagActivatesAnImageThatWasCompleteWhenThePowerFailed) {
  const Buffer image = image_of(100);
  Bench bench;
  bench.begin(image, 0x0101, kActivateWhenComplete);
  bench.holds = true;
  bench.block(image, 0);
  for (int jobs = 0; jobs < 5; ++jobs) {  // erase, the block, its mark
    bench.end_job();
    bench.update().poll(bench.now);
  }
  bench.holds = false;
  bench.reset();
  EXPECT_EQ(bench.running(), 0U);
  EXPECT_EQ(bench.update().state(), State::Activating);
}

TEST(Update, AnImageThatIsDamagedAfterItsActivationIsTakenBack) {
  const Buffer image = image_of(100);
  Bench bench;
  bench.begin(image);
  bench.blocks(image);
  bench.ask(Ask::Activate);
  bench.spare()[kImageAt] ^= 1U;
  bench.reset();
  EXPECT_EQ(bench.running(), 0U);
  EXPECT_EQ(bench.update().state(), State::TakenBack);
}

TEST(Update, NothingBeginsWhileAnActivationIsPending) {
  const Buffer image = image_of(100);
  Bench bench;
  bench.begin(image);
  bench.blocks(image);
  bench.ask(Ask::Activate);
  ASSERT_EQ(bench.update().state(), State::Activating);
  EXPECT_EQ(bench.begin(image, 0x0102), Refusal::UpdateRefused);
  EXPECT_EQ(bench.block(image, 0), Refusal::WrongValue);
}

TEST(Update, AnImageThatHasBeenTriedIsTakenBackEvenIfTheMarkOfItsActivationHasDecayed) {
  const Buffer image = image_of(100);
  Bench bench;
  bench.begin(image);
  bench.blocks(image);
  bench.ask(Ask::Activate);
  bench.slots().mark_tried(1);
  bench.spare()[kMarksAt + kActivated] = 0x55;
  bench.reset();
  EXPECT_EQ(bench.update().state(), State::TakenBack);
}

/// A debug probe has written it to RAM.
TEST(Update, ARunningImageThatIsInNoSlotCanBeUpdated) {
  SlotHead no_head{};
  Update update;
  update.start(
      {0, kTestBoard, {Bytes{no_head.data(), no_head.size()}, Bytes{no_head.data(), no_head.size()}}},
      the_model());
  EXPECT_EQ(update.state(), State::None);
  const Buffer info = info_of(image_of(100));
  update.accept({Ask::Begin, {info.data(), info.size()}}, Time(1));
  update.poll(Time(1));
  EXPECT_EQ(update.job().slot, 1) << "its slot must not be written";
}

TEST(Boot, AnImageWhoseMarkIsNotKeptDoesNotStart) {
  const Buffer image = image_of(100);
  Bench bench;
  bench.begin(image);
  bench.blocks(image);
  bench.ask(Ask::Activate);
  bench.slots().marks = false;
  EXPECT_EQ(choose(bench.slots()), 0U);
  bench.slots().marks = true;
  EXPECT_EQ(choose(bench.slots()), 1U);
}

TEST(Boot, NoDamagedImageStarts) {
  Slots slots;
  slots.cells[0][kImageAt] ^= 1U;
  EXPECT_EQ(choose(slots), std::nullopt);
  slots.cells[1] = slots.cells[0];
  EXPECT_EQ(choose(slots), std::nullopt);
}

TEST(Update, WithoutSlotsThereIsNothingToDo) {
  Update update;
  update.poll(Time(5));
  EXPECT_FALSE(update.busy());
}

}  // namespace
}  // namespace ex9000::update
