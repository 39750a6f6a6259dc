// `ex9000 set` on a bad line: any one frame is lost or damaged, or the line ends, or the user stops it.
#include <gtest/gtest.h>

#include "tests/sim/utility/plant.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::utility {
namespace {

struct Task {
  const char* model;
  const char* module;
  std::vector<std::string> settings;
  unsigned new_address;  ///< at once; 0: at the next reset
};

const Task kTasks[] = {
    {"EX9052D-M",
     "EX9052D-M@05",
     {"edge=rising", "input-filters=7", "inverted-inputs=0081", "watchdog-timeout=20s",
      "watchdog-feed=requests", "response-delay=2", "baud=19200", "address=9", "watchdog=on"},
     0},
    {"EX9044D",
     "EX9044D@05,checksum=on",
     {"name=TANK", "power-on-value=0003", "safe-value=0001", "watchdog-timeout=20s", "response-delay=2",
      "input-filters=7", "address=9", "watchdog=on"},
     9},
};

class OnABadLine : public testing::TestWithParam<Task> {
 protected:
  OnABadLine() { begin_anew(); }

  void begin_anew() { plant_ = std::make_unique<Plant>(std::vector<std::string>{GetParam().module}); }

  int set(unsigned address) {
    std::vector<std::string> words{"set", "port", std::to_string(address), "--model", GetParam().model};
    words.insert(words.end(), GetParam().settings.begin(), GetParam().settings.end());
    return plant_->run(words);
  }

  Settings stored() { return settings_from(*find_model(GetParam().model), plant_->memory().data()); }

  /// The number of frames of an undisturbed run, after which `wanted_` is stored.
  std::size_t frames() {
    EXPECT_EQ(set(5), 0) << plant_->error();
    wanted_ = stored();
    return plant_->sent.size();
  }

  /// What has been interrupted can be done again.
  void finish() {
    plant_->sends = [](const Data& /*frame*/) { return true; };
    plant_->wait();
    const bool moved = GetParam().new_address != 0 && stored().address == GetParam().new_address;
    EXPECT_EQ(set(moved ? GetParam().new_address : 5), 0) << plant_->error();
    EXPECT_TRUE(stored() == wanted_);
  }

  std::unique_ptr<Plant> plant_;
  Settings wanted_;
};

TEST_P(OnABadLine, ALostRequestIsRepeated) {
  const std::size_t count = frames();
  for (std::size_t lost = 0; lost < count; ++lost) {
    SCOPED_TRACE(lost);
    begin_anew();
    plant_->sends = [&](const Data& /*frame*/) { return plant_->sent.size() != lost + 1; };
    EXPECT_EQ(set(5), 0) << plant_->error();
    EXPECT_TRUE(stored() == wanted_);
  }
}

TEST_P(OnABadLine, ALostOrDamagedReplyIsAskedForAgain) {
  const std::size_t count = frames();
  for (std::size_t bad = 0; bad < 2 * count; ++bad) {
    SCOPED_TRACE(bad);
    begin_anew();
    plant_->hears = [&](std::size_t at, std::uint8_t byte) -> std::optional<std::uint8_t> {
      if (plant_->sent.size() != bad / 2 + 1) {
        return byte;
      }
      if (bad % 2 == 0) {
        return std::nullopt;
      }
      return at == 3 ? static_cast<std::uint8_t>(byte ^ 0x11U) : byte;
    };
    EXPECT_EQ(set(5), 0) << plant_->error();
    EXPECT_TRUE(stored() == wanted_);
  }
}

TEST_P(OnABadLine, WhatEndsInBetweenCanBeDoneAgain) {
  const std::size_t count = frames();
  for (std::size_t last = 0; last < count; ++last) {
    SCOPED_TRACE(last);
    begin_anew();
    plant_->sends = [&](const Data& /*frame*/) { return plant_->sent.size() <= last; };
    EXPECT_EQ(set(5), 1);
    finish();

    begin_anew();
    plant_->sends = [&](const Data& /*frame*/) -> bool {
      if (plant_->sent.size() > last) {
        throw Interrupted();
      }
      return true;
    };
    EXPECT_EQ(set(5), 130);
    finish();
  }
}

INSTANTIATE_TEST_SUITE_P(Protocols, OnABadLine, testing::ValuesIn(kTasks),
                         [](const auto& info) { return info.index == 0 ? "Modbus" : "Ascii"; });

}  // namespace
}  // namespace ex9000::utility
