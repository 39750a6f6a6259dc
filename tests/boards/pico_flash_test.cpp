// Tests the flash driver in the emulator. A test program runs from RAM. It erases the flash and writes to the
// flash, while its interrupt handler receives bytes. Also tests that this program finds the reason of each
// reset.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>

#include "firmware/reset_reason.hpp"
#include "tests/rp2040/pico_bench.hpp"

namespace ex9000::pico {
namespace {

using std::chrono::milliseconds;

/// The words of Results in tests/rp2040/flash_exercise/main.cpp, in the same order.
enum Result : std::uint32_t { Received, Unexpected, Rounds, Wrong, Erasing, Reason };

class PicoFlash : public testing::Test {
 protected:
  PicoFlash() {
    bench_.begin_with(program_for_tests("flash_exercise"));
    bench_.set_baud(115200);
  }

  unsigned long result(Result which) {
    constexpr std::uint32_t kResults = 0x2004'1000;
    return std::stoul(bench_.execute("read " + std::to_string(kResults + 4U * which)));
  }
  void wait_for_erase() {
    for (int i = 0; i < 1000 && result(Erasing) != 1; ++i) {
      bench_.run_for(milliseconds(1));
    }
    ASSERT_EQ(result(Erasing), 1U);
  }

  PicoBench bench_;
};

TEST_F(PicoFlash, NoByteIsLostDuringAnErase) {
  bench_.power(true);
  bench_.run_for(milliseconds(100));
  wait_for_erase();  // the erase takes 45 ms, and the bytes take 49 ms
  play::Bytes bytes;
  for (unsigned i = 0; i < 560; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i));
  }
  bench_.send(bytes);
  bench_.run_for(milliseconds(1));
  EXPECT_EQ(result(Received), bytes.size());
  EXPECT_EQ(result(Unexpected), 0U);
  EXPECT_EQ(result(Wrong), 0U);
}

TEST_F(PicoFlash, BytesWithoutAPauseAndFlashOperationsWithoutAPauseDoNotDisturbEachOther) {
  bench_.power(true);
  bench_.run_for(milliseconds(100));
  constexpr unsigned kParts = 40;
  play::Bytes bytes;
  for (unsigned i = 0; i < 256; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i));
  }
  for (unsigned part = 0; part < kParts; ++part) {
    bench_.send(bytes);
  }
  bench_.run_for(milliseconds(1));
  EXPECT_EQ(result(Received), kParts * bytes.size());
  EXPECT_EQ(result(Unexpected), 0U);
  EXPECT_GE(result(Rounds), 5U);
  EXPECT_EQ(result(Wrong), 0U);
  EXPECT_EQ(bench_.counts().at("timeouts"), 0);
}

TEST_F(PicoFlash, TheDriverWorksWithTheLongestEraseAndProgramTimes) {
  bench_.execute("flash-times 400000000 3000000");
  bench_.power(true);
  bench_.run_for(milliseconds(2000));
  EXPECT_GE(result(Rounds), 2U);
  EXPECT_EQ(result(Wrong), 0U);
  EXPECT_EQ(bench_.counts().at("timeouts"), 0);
}

TEST_F(PicoFlash, TheProgramFindsTheReasonOfEachReset) {
  constexpr std::string_view kBranchToItself = " 59390";
  constexpr std::string_view kUndefined = " 56832";
  bench_.power(true);
  bench_.run_for(milliseconds(100));
  EXPECT_EQ(result(Reason), static_cast<unsigned>(ResetReason::PowerOn));
  for (const auto& [instruction, reason] :
       {std::pair{kBranchToItself, ResetReason::ModuleWatchdog}, std::pair{kUndefined, ResetReason::Fault}}) {
    bench_.execute("write " + bench_.execute("pc") + std::string(instruction));
    bench_.run_for(milliseconds(1700));
    EXPECT_EQ(result(Reason), static_cast<unsigned>(reason));
  }
  bench_.reset();
  bench_.run_for(milliseconds(100));
  EXPECT_EQ(result(Reason), static_cast<unsigned>(ResetReason::ResetPin));
}

}  // namespace
}  // namespace ex9000::pico
