// Tests the double of an EEPROM: after a power failure, the bytes that it has saved must equal its contents.
#include "hal/doubles/memory.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace ex9000::hal::doubles {
namespace {

TEST(MemoryDouble, TheSavedBytesAreTheContentsAfterACutAtAnyTime) {
  constexpr std::uint16_t kAddress = 64;
  constexpr std::array<std::uint8_t, 8> kBytes{1, 2, 3, 4, 5, 6, 7, 8};
  constexpr VirtualTime kJob = Memory::kProgram + Memory::kByteOnBus * (kBytes.size() + 4);
  int partly_written = 0;
  for (VirtualTime cut{0}; cut <= kJob; cut += std::chrono::microseconds(50)) {
    VirtualClock clock;
    Memory memory(clock);
    std::fill(memory.contents().begin(), memory.contents().end(), std::uint8_t{0});
    std::vector<std::uint8_t> saved = memory.contents();
    memory.keep([&saved](std::uint16_t address, Bytes bytes) {
      std::copy(bytes.begin(), bytes.end(), saved.begin() + address);
      return true;
    });
    memory.start_write(kAddress, {kBytes.data(), kBytes.size()}, clock.now());
    EXPECT_EQ(memory.writes(), 1U);
    clock.set(cut);
    memory.cut();
    ASSERT_TRUE(saved == memory.contents()) << cut.count() << " ns";
    partly_written += saved[kAddress] == kBytes.front() && saved[kAddress + kBytes.size() - 1] == 0 ? 1 : 0;
  }
  EXPECT_GT(partly_written, 50);
}

}  // namespace
}  // namespace ex9000::hal::doubles
