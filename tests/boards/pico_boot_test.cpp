// Tests which image the second stage and the loader start.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include "firmware/update/signature.hpp"
#include "tests/boards/pico_slots.hpp"

namespace ex9000::pico {
namespace {

using PicoBoot = PicoSlots;

TEST_F(PicoBoot, TheHeadOfTheBuildNamesModelBoardAndVersion) {
  const update::Slot slot = old_.slot();
  EXPECT_TRUE(slot.valid);
  EXPECT_TRUE(slot.confirmed);
  EXPECT_EQ(slot.sequence, 1U);
  EXPECT_EQ(slot.sectors, update::kImageSectors);
  const auto signature = update::signature_of(*find_model(kModel), "pico");
  EXPECT_TRUE(std::equal(signature.begin(), signature.end(), slot.info.signature().begin()));
  EXPECT_EQ(slot.info.version(), version_in_bcd());
  EXPECT_EQ(slot.info.flags(), 0);
  for (const std::uint8_t byte : slot.info.reserved()) {
    EXPECT_EQ(byte, 0);
  }
  EXPECT_FALSE(update::Slot({flash(1, 0, update::kSlotHeadSize).data(), update::kSlotHeadSize}).valid);
}

TEST_F(PicoBoot, TheNewerOfTwoConfirmedImagesStarts) {
  constexpr std::uint32_t kStartedSlot = 0x4005'8014;
  for (const unsigned newer : {0U, 1U}) {
    put(newer, new_);
    put(1 - newer, old_);
    EXPECT_EQ(version_after_power_on(), kNewVersion);
    EXPECT_EQ(number("read " + std::to_string(kStartedSlot)) & 0xFFU, newer);
    EXPECT_EQ(version_after("reset"), kNewVersion);
  }
}

/// Neither a damaged image nor one that the firmware has not activated starts, whatever its sequence number.
TEST_F(PicoBoot, OnlyACompleteImageStarts) {
  using Damage = std::function<void(Content&)>;
  const auto flip = [](std::size_t at) { return [at](Content& content) { content.image[at] ^= 0x10U; }; };
  const auto head = [](std::size_t at) { return [at](Content& content) { content.head[at] ^= 0x01U; }; };
  const auto with_length = [](std::size_t length) {
    return [length](Content& content) {
      content.image.resize(length, 0xFF);
      content.seal(content.slot().sequence);
    };
  };
  const std::size_t length = old_.image.size();
  const std::pair<const char*, Damage> kDamages[] = {
      {"first byte", flip(0)},
      {"a byte in the middle", flip(length / 2)},
      {"last byte", flip(length - 1)},
      {"cut", [&](Content& content) { std::fill(content.image.begin() + 4096, content.image.end(), 0xFF); }},
      {"magic", head(0)},
      {"sequence", head(11)},
      {"length", head(27)},
      {"CRC of the image", head(35)},
      {"CRC of the header", head(47)},
      {"no image", with_length(0)},
      {"too long", with_length(update::kLargestImage + 1)},
      {"not activated",
       [](Content& content) {
         for (const auto mark : {update::kActivated, update::kTried, update::kConfirmed}) {
           content.mark(mark) = 0xFF;
         }
       }},
      {"tried, not confirmed", [](Content& content) { content.mark(update::kConfirmed) = 0xFF; }},
  };
  for (const auto& [what, damage] : kDamages) {
    SCOPED_TRACE(what);
    Content damaged_new = new_;
    damage(damaged_new);
    damaged_new.image.resize(std::min<std::size_t>(damaged_new.image.size(), length));
    for (const unsigned damaged : {0U, 1U}) {
      put(damaged, damaged_new);
      put(1 - damaged, old_);
      EXPECT_EQ(version_after_power_on(), kOldVersion);
    }
  }
}

TEST_F(PicoBoot, WithoutACompleteImageNothingStartsUntilThereIsOne) {
  put(1, new_);
  for (const unsigned slot : {0U, 1U}) {
    set_flash(address_of(slot, kImageAt), {0x55});
  }
  EXPECT_EQ(version_after_power_on(), "");
  bench_.run_for(kWatchdogPeriod);
  EXPECT_EQ(number("driven"), 0U);
  EXPECT_EQ(bench_.counts().at("timeouts"), 1);
  put(0, old_);
  EXPECT_EQ(version_after("heard"), kOldVersion);
}

TEST_F(PicoBoot, AnImageThatIsNotConfirmedStartsOnce) {
  for (const unsigned tried : {0xFFU, 0xF0U, 0x01U}) {  // after a power failure while it was programmed
    SCOPED_TRACE(tried);
    new_.mark(update::kConfirmed) = 0xFF;
    new_.mark(update::kTried) = static_cast<std::uint8_t>(tried);
    put(0, old_);
    put(1, new_);
    EXPECT_EQ(version_after_power_on(), kNewVersion);
    EXPECT_EQ(mark(1, update::kTried), 0);
    EXPECT_EQ(version_after("reset"), kOldVersion);
    EXPECT_EQ(version_after_power_on(), kOldVersion);
  }
}

TEST_F(PicoBoot, AnImageWhoseStartCannotBeMarkedDoesNotStart) {
  new_.mark(update::kConfirmed) = 0xFF;
  new_.mark(update::kTried) = 0xFF;
  put(1, new_);
  bench_.execute("stick " + address_of(1, kMarksAt + update::kTried));
  EXPECT_EQ(version_after_power_on(), kOldVersion);
}

TEST_F(PicoBoot, AnImageThatHangsIsResetByTheWatchdogAndTheOldOneStarts) {
  new_.replace_first_instruction(kReset, kBranchToItself);
  new_.mark(update::kConfirmed) = 0xFF;
  new_.mark(update::kTried) = 0xFF;
  new_.seal(2);
  put(1, new_);
  EXPECT_EQ(version_after_power_on(), "");
  bench_.run_for(kWatchdogPeriod);
  EXPECT_EQ(version_after("heard"), kOldVersion);
  EXPECT_EQ(bench_.counts().at("timeouts"), 1);
}

/// The suspended erase is one of the log of the settings.
TEST_F(PicoBoot, AResetWhileAnEraseIsSuspendedDoesNotPreventATry) {
  bench_.forget_erased_sectors();
  bench_.execute("flash-times 400000000 3000000");
  ASSERT_EQ(version_after_power_on(), kOldVersion);
  new_.mark(update::kConfirmed) = 0xFF;
  new_.mark(update::kTried) = 0xFF;
  put(1, new_);
  bench_.run_for(milliseconds(400));  // until a sector is erased
  bench_.send(text("~01OVALVE\r"));
  bench_.run_for(milliseconds(5));  // the record is being programmed
  EXPECT_EQ(version_after("reset"), kNewVersion);
  EXPECT_EQ(mark(1, update::kTried), 0);
  EXPECT_EQ(ask("$01M"), "!01VALVE\r");
  bench_.run_for(milliseconds(7'000));
  EXPECT_EQ(ask("~01OPUMP"), "!01\r");
}

TEST_F(PicoBoot, AUf2FileWinsOverANewerImageInSlot1AndKeepsTheSettings) {
  put(1, new_);
  ASSERT_EQ(version_after_power_on(), kNewVersion);
  ASSERT_EQ(ask("~01OPUMP"), "!01\r");
  bench_.power(false);
  std::ifstream file("build/pico/" + std::string(kModel) + ".uf2", std::ios::binary);
  const Bytes uf2{std::istreambuf_iterator<char>(file), {}};
  constexpr std::size_t kBlock = 512;
  ASSERT_NE(uf2.size(), 0U);
  for (std::size_t at = 0; at < uf2.size(); at += kBlock) {
    const ex9000::Bytes address{&uf2[at + 12], 4};
    set_flash(std::to_string(address.low_byte_first_32(0) & 0xFF'FFFFU),
              Bytes(&uf2[at + 32], &uf2[at + 32 + 256]));
  }
  EXPECT_EQ(version_after("power-after-copy"), kOldVersion);
  EXPECT_EQ(ask("$01M"), "!01PUMP\r");
}

}  // namespace
}  // namespace ex9000::pico
