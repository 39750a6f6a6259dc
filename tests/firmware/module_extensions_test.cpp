// Tests counts of extensions at their limits, and reset reasons (firmware/extensions.md).
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/request/statistics.hpp"
#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(ResetReasons, DifferForPowerOnForTheResetPinAndForTheModuleWatchdog) {
  ModuleBench bench("EX9043D,baud=115200");
  EXPECT_EQ(bench.ask("~01X0301"), "!010001");
  bench.module().reset();
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("~01X0301"), "!010004");
  bench.module().hang();
  bench.run(seconds(3));
  EXPECT_EQ(bench.ask("~01X0301"), "!010002");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~01X0301"), "!010001");
}

TEST(Uptime, CountsSecondsBeyondTheRangeOfTheClock) {
  ModuleBench bench("EX9043D,baud=115200");
  bench.run(std::chrono::hours(2));
  const std::string reply = bench.ask("~01X0302");
  ASSERT_EQ(reply.size(), 11U);
  EXPECT_EQ(reply.substr(3), "00001C20");  // 7200
  bench.run(std::chrono::hours(17));
  EXPECT_EQ(bench.ask("~01X0302").substr(3), "00010B30");  // 68400, beyond 16 bits
  bench.module().reset();
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("~01X0302"), "!0100000000");
}

TEST(TimeoutCount, StopsAt65535) {
  ModuleBench bench("EX9043D,baud=115200");
  for (int i = 0; i < 0xFFFF; ++i) {
    bench.send("~013101\r");
    bench.run(milliseconds(200));
  }
  EXPECT_EQ(bench.ask("~01X0304"), "!01FFFF");
  ASSERT_EQ(bench.ask("~013101"), "!01");
  EXPECT_EQ(bench.ask("~01X0304"), "!01FFFF");
}

std::vector<std::uint8_t> read_word(std::uint8_t high, std::uint8_t low) {
  return {0x01, 0x03, high, low, 0, 1};
}

TEST(LineTallyRegisters, CountDamagedBytesModulo65536) {
  ModuleBench bench("EX9043D-M,baud=115200");
  for (unsigned i = 0; i < 0x10004; ++i) {
    bench.module().receive(0x55, i % 2 == 0 ? ByteStatus::FramingError : ByteStatus::ParityError);
  }
  bench.run(milliseconds(10));
  EXPECT_EQ(bench.ask(read_word(0x03, 0x0E)), (std::vector<std::uint8_t>{0x01, 0x03, 2, 0, 4}));
}

TEST(Statistics, ACountStopsAt65535) {
  std::uint16_t count = 0xFFFE;
  count_saturating(count);
  EXPECT_EQ(count, 0xFFFF);
  count_saturating(count);
  EXPECT_EQ(count, 0xFFFF);
}

}  // namespace
}  // namespace ex9000::sim
