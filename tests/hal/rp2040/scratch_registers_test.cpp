// Tests what the drivers keep in the scratch registers of the watchdog over a reset. Source: RP2040 data
// sheet, 4.7.6.
#include <gtest/gtest.h>

#include <cstdint>
#include <map>

#include "hal/rp2040/kept_word.hpp"
#include "hal/rp2040/started_slot.hpp"
#include "hal/rp2040/watchdog.hpp"
#include "tests/hal/rp2040/bus.hpp"

namespace ex9000 {
namespace {

constexpr std::uint32_t kSetTrigger = 0x4005'A000;
constexpr std::uint32_t kReason = 0x4005'8008;
constexpr std::uint32_t kFirstScratch = 0x4005'800C;
constexpr std::uint32_t kLastScratch = 0x4005'8028;

struct Reset {};

/// Scratch registers that survive a reset, and the reason of the reset.
class Watchdog final : public rp2040_model::Bus {
 public:
  std::uint32_t read(std::uint32_t address) override { return registers[address]; }
  void write(std::uint32_t address, std::uint32_t value) override {
    if (address >= kFirstScratch && address <= kLastScratch) {
      registers[address] = value;
    } else if (address == kSetTrigger && (value & 1U << 31U) != 0) {
      registers[kReason] = 1U << 1U;
      throw Reset();
    }
  }

  std::map<std::uint32_t, std::uint32_t> registers;
};

using Driver = hal::rp2040::HardwareWatchdog<12>;

TEST(ScratchRegisters, ARestartIsASoftwareResetAndNotAFault) {
  Watchdog watchdog;
  Driver::start();
  EXPECT_THROW(Driver::reset_chip(), Reset);
  EXPECT_EQ(Driver::reset_reason(), ResetReason::Fault);
  EXPECT_THROW(Driver::restart(), Reset);
  EXPECT_EQ(Driver::reset_reason(), ResetReason::Software);
}

TEST(ScratchRegisters, TheCountdownOfTheLoaderDoesNotChangeTheReason) {
  Watchdog watchdog;
  watchdog.registers[kReason] = 1;
  Driver::start_countdown();
  EXPECT_EQ(Driver::reset_reason(), ResetReason::Software);
  Driver::start();
  Driver::start_countdown();
  EXPECT_EQ(Driver::reset_reason(), ResetReason::ModuleWatchdog);
}

TEST(ScratchRegisters, HaveRoomForMarkWordAndSlot) {
  using hal::rp2040::KeptWord;
  using hal::rp2040::StartedSlot;
  Watchdog watchdog;
  watchdog.registers[kReason] = 1;
  EXPECT_EQ(StartedSlot::load(), 0U);
  watchdog.registers[kFirstScratch + 8] = 1;  // of other software
  EXPECT_EQ(StartedSlot::load(), 0U);
  Driver::start();
  KeptWord::store(1);
  for (const unsigned slot : {1U, 0U}) {
    StartedSlot::store(slot);
    EXPECT_EQ(StartedSlot::load(), slot);
    EXPECT_EQ(KeptWord::load(), 1U);
    EXPECT_EQ(Driver::reset_reason(), ResetReason::ModuleWatchdog);
  }
}

}  // namespace
}  // namespace ex9000
