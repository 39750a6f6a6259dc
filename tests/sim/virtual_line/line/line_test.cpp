#include "sim/virtual_line/line/line.hpp"

#include <gtest/gtest.h>

#include <array>

#include "sim/notation/module_notation.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

TEST(LineOfOneModule, IsPendingFromTheCallOfSendToTheEndOfTheReply) {
  bool replied = false;
  Line line({parse_module_spec("EX9042D@01")}, kPaced,
            [&replied](std::uint8_t byte, ByteStatus /*status*/) { replied = byte == '\r'; });
  line.come_up();
  ASSERT_FALSE(line.pending());

  constexpr std::array<std::uint8_t, 5> kReadName{'$', '0', '1', 'M', '\r'};
  line.master().send(kReadName.data(), kReadName.size(), line.clock().virtual_now() + milliseconds(5));
  EXPECT_TRUE(line.pending()) << "no byte is on the wires yet, but five bytes wait";

  for (int passed = 0; line.pending() && passed < 100; ++passed) {
    EXPECT_FALSE(replied);
    line.wires().run_for(milliseconds(1));
  }
  EXPECT_TRUE(replied);
  EXPECT_FALSE(line.pending());
}

}  // namespace
}  // namespace ex9000::sim
