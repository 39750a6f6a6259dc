// Cuts the power at every operation of updates and stores, with the boot loader's decision, the driver of the
// slots and the log of the settings on the model of a flash. After each cut, one of the permitted images must
// start, and the settings must be those that were acknowledged or those that were being stored:
// extensions.md, "Firmware update". The model also fails the test if anything relies on bytes that an
// interrupted operation has left.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "firmware/update/boot.hpp"
#include "firmware/update/update.hpp"
#include "hal/flash/image_slots.hpp"
#include "tests/firmware/update/messages.hpp"
#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

using update::Ask;
using update::block_of;
using update::Buffer;
using update::info_of;
using update::State;
using Slots = ImageSlots<Log, FlashChip::kSlots>;

struct Image {
  std::uint16_t version = 0;
  Buffer bytes;
};

/// For update::choose, on the chip alone.
struct Loader {
  FlashChip& chip;
  unsigned marking = 0;

  static std::uint32_t address_of(unsigned slot) { return FlashChip::kSlots + slot * update::kSlotSize; }
  [[nodiscard]] update::SlotHead head(unsigned slot) const {
    update::SlotHead head{};
    chip.read(address_of(slot), {head.data(), head.size()});
    return head;
  }
  [[nodiscard]] bool load(unsigned slot, const update::Info& info) const {
    if (info.length() == 0 || info.length() > update::kLargestImage) {
      return false;
    }
    Buffer image(info.length());
    chip.read(address_of(slot) + update::kImageAt, {image.data(), image.size()});
    return update::crc32({image.data(), image.size()}) == info.check();
  }
  /// During this, the power may fail: then the image may have had its chance.
  [[nodiscard]] bool mark_tried(unsigned slot) {
    marking = slot;
    constexpr std::uint32_t kMark = update::kMarksAt + update::kTried;
    chip.start_program(address_of(slot) + kMark, {&update::kMarked, 1});
    while (chip.busy()) {
      chip.run(100);
    }
    return head(slot)[kMark] == update::kMarked;
  }
};

/// What a reset may find.
struct Expected {
  std::set<std::uint16_t> versions;
  /// Also these, if a mark decays that the power has cut: until something else is acknowledged.
  std::set<std::uint16_t> doubts;
  /// The power has cut the mark `tried`, so it may decay into place after the next activation.
  bool chance_in_doubt = false;
  std::vector<Settings> settings;
  bool transfer_was_cut = false;
  unsigned begun_anew = 0;  ///< transfers that were cut, and whose image was then wrong: see slot.hpp

  void power_failed() {
    transfer_was_cut = true;
    if (versions.size() > 1) {
      doubts.insert(versions.begin(), versions.end());
    }
  }
  void acknowledged(std::set<std::uint16_t> now) {
    versions = std::move(now);
    doubts.clear();
    transfer_was_cut = false;
  }
};

/// A module from one reset to the next, with its master.
class Powered {
 public:
  /// Starts, and checks what starts.
  Powered(FlashChip& chip, Expected& expected)
      : chip_(chip), expected_(expected), version_(boot()), settings_(chip) {
    const auto& permitted = expected.settings;
    EXPECT_NE(std::find(permitted.begin(), permitted.end(), settings_.stored()), permitted.end())
        << "the settings are lost";
    expected.settings = {settings_.stored()};
    slots_.begin(slot_, update::kTestBoard);
    update_.start(slots_.origin(), update::the_model());
  }

  /// Brings `image` into force, and stores settings meanwhile. False: a reset is due.
  bool update_to(const Image& image, bool flag, unsigned& stored) {
    if (update_.state() == State::Unconfirmed) {
      expected_.versions.insert(version_);
      EXPECT_EQ(ask(Ask::Confirm), Refusal::None);
      expected_.acknowledged({version_});
    }
    if (version_ == image.version) {
      return true;
    }
    if (flag) {
      expected_.versions.insert(image.version);  // complete images activate themselves, also after a reset
    }
    settle();
    if (update_.state() != State::Activating) {
      send(image, flag, stored);
      if (update_.state() == State::None && expected_.transfer_was_cut) {
        ++expected_.begun_anew;
        send(image, flag, stored);
      }
    }
    if (update_.state() == State::Complete) {
      expected_.versions.insert(image.version);
      EXPECT_EQ(ask(Ask::Activate), Refusal::None);
    }
    EXPECT_EQ(update_.state(), State::Activating);
    expected_.acknowledged({image.version});
    if (expected_.chance_in_doubt) {
      expected_.versions.insert(version_);
    }
    return false;
  }

 private:
  std::uint16_t boot() {
    Loader loader{chip_};
    std::optional<unsigned> chosen;
    try {
      chosen = update::choose(loader);
    } catch (const PowerFailure&) {
      expected_.versions.insert(version_in(1 - loader.marking));
      expected_.chance_in_doubt = true;
      throw;
    }
    if (!chosen) {
      ADD_FAILURE() << "no image starts";
      throw std::runtime_error("no image starts");
    }
    slot_ = *chosen;
    const std::uint16_t version = version_in(slot_);
    EXPECT_NE(expected_.versions.count(version) + expected_.doubts.count(version), 0U)
        << version << " starts";
    const update::SlotHead head = loader.head(slot_);
    const bool confirmed = update::Slot({head.data(), head.size()}).confirmed;
    expected_.chance_in_doubt = expected_.chance_in_doubt && confirmed;
    expected_.versions = {confirmed ? version : version_in(1 - slot_)};  // it gets only one chance
    return version;
  }
  [[nodiscard]] std::uint16_t version_in(unsigned slot) const {
    const update::SlotHead head = Loader{chip_}.head(slot);
    return update::Slot({head.data(), head.size()}).info.version();
  }

  void send(const Image& image, bool flag, unsigned& stored) {
    ASSERT_EQ(ask(Ask::Begin, info_of(image.bytes, image.version, flag ? update::kActivateWhenComplete : 0)),
              Refusal::None);
    unsigned refused = 0;
    while (update_.state() == State::Receiving && !testing::Test::HasFailure()) {
      const std::uint32_t next = update_.next();
      if (next % 512 == 0) {
        save(++stored);
      }
      // A block may have to wait for erases of the log for more than 400 ms; then a master sends it again.
      const Refusal refusal = ask(Ask::Block, block_of(image.bytes, next));
      ASSERT_TRUE(refusal == Refusal::None || (refusal == Refusal::UpdateRefused && ++refused < 1000));
      expected_.doubts.clear();
      expected_.chance_in_doubt = expected_.chance_in_doubt && next != 0;
    }
  }

  Refusal ask(Ask what, const Buffer& data = {}) {
    const update::Request request{what, {data.data(), data.size()}};
    const Refusal refusal = update_.judge(request, true);
    if (refusal != Refusal::None) {
      return refusal;
    }
    update_.accept(request, chip_.time());
    while (!update_.answered()) {
      pass();
    }
    return update_.answer();
  }

  /// Begins to store settings; the following requests go on meanwhile.
  void save(unsigned number) {
    settle_save();
    Settings settings = numbered(number);
    expected_.settings.push_back(settings);
    settings_.begin_save(settings);
    saving_ = true;
  }
  void settle_save() {
    while (saving_) {
      pass();
    }
  }
  /// Until the slots have no work.
  void settle() {
    for (int quiet = 0; quiet < 4; ++quiet) {
      pass();
      quiet = update_.busy() ? 0 : quiet;
    }
  }

  void pass() {
    bool again = settings_.log().poll(chip_.time());
    if (saving_ && !settings_.log().busy()) {
      settings_.keeper().done(settings_.log().result());
      saving_ = settings_.keeper().busy();
      if (saving_) {
        settings_.log().start(settings_.keeper().job(), chip_.time());  // it had to load again first
        return;
      }
      EXPECT_TRUE(settings_.keeper().saved());
      expected_.settings = {settings_.stored()};
    }
    update_.poll(chip_.time());
    again = slots_.poll(chip_.time()) || again;
    if (under_way_ && !slots_.busy()) {
      under_way_ = false;
      update_.done();
    } else if (!under_way_ && update_.busy()) {
      slots_.start(update_.job(), chip_.time());
      under_way_ = true;
    }
    chip_.run(again ? 10 : 200);
  }

  FlashChip& chip_;
  Expected& expected_;
  unsigned slot_ = 0;
  std::uint16_t version_;
  OnFlash settings_;
  Slots slots_{settings_.log()};
  update::Update update_;
  bool under_way_ = false;
  bool saving_ = false;
};

FlashChip with_an_image(const Image& image) {
  FlashChip chip = settled();
  chip.add_slots();
  update::Info info;
  const Buffer bytes = info_of(image.bytes, image.version, 0);
  std::copy(bytes.begin(), bytes.end(), info.bytes.begin());
  const update::Header header = update::header_of(info, 1);
  std::fill_n(chip.slots(), update::kSlotHeadSize, std::uint8_t{0});
  std::copy(header.begin(), header.end(), chip.slots());
  std::copy(image.bytes.begin(), image.bytes.end(), chip.slots() + update::kImageAt);
  return chip;
}

Image any_image(std::uint16_t version, std::mt19937& random) {
  return {version, update::image_of(1 + random() % 9000, static_cast<std::uint8_t>(random()))};
}

/// Of the operation that is running, or of the next.
Tear any_tear(std::mt19937& random) {
  return {Tear::kEveryKind[random() % 5], random() % (random() % 2 == 0 ? 130U : 4097U),
          static_cast<unsigned>(random())};
}

unsigned cuts_wanted() {
  const char* const wanted = std::getenv("EX9000_CUTS");
  return wanted == nullptr ? 2000 : static_cast<unsigned>(std::strtoul(wanted, nullptr, 10));
}

TEST(UpdateCuts, AnUpdateGoesOnAfterCutsAtRandomOperations) {
  std::mt19937 random(1);
  std::uint16_t version = 1;
  FlashChip chip = with_an_image(any_image(version, random));
  Expected expected{{version}, {}, false, {factory()}, false, 0};
  unsigned stored = 0;
  unsigned cuts = 0;
  unsigned updates = 0;
  const unsigned wanted = cuts_wanted();
  for (; cuts < wanted && !HasFailure(); ++updates) {
    const Image image = any_image(++version, random);
    const bool flag = random() % 2 == 0;
    for (bool done = false; !done && !HasFailure();) {
      const std::size_t most = random() % 4 == 0 ? 6 : 60;
      if (random() % 3 == 0) {
        chip.let_slots_decay(static_cast<unsigned>(random()));
      }
      chip.cut(chip.earliest_open() + random() % most, any_tear(random));
      try {
        Powered module(chip, expected);
        done = module.update_to(image, flag, stored);
        if (random() % 2 == 0) {
          chip.power_off(any_tear(random));  // or a reset of the MCU
        }
      } catch (const PowerFailure&) {
        ++cuts;
        expected.power_failed();
      }
    }
  }
  std::printf("%u cuts, %u updates, %u begun anew\n", cuts, updates, expected.begun_anew);
  EXPECT_LE(expected.begun_anew, 1 + cuts / 50'000);
}

}  // namespace
}  // namespace ex9000::hal::flash
