// Tests CRC-16/MODBUS. Sources of the example frames: wire.md section 7 and Modbus over Serial Line V1.02.
#include "firmware/line/crc16.hpp"

#include <gtest/gtest.h>

#include <string_view>
#include <vector>

namespace ex9000 {
namespace {

using FrameBytes = std::vector<std::uint8_t>;

Crc16 crc_of(const FrameBytes& bytes) { return crc16({bytes.data(), bytes.size()}); }

/// The example frames of wire.md section 7, with their CRCs.
const std::vector<FrameBytes> kWorkedFrames{
    {0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3A},
    {0x01, 0x85, 0x04, 0x43, 0x53},
    {0x01, 0x01, 0x00, 0x00, 0x00, 0x0D, 0xFD, 0xCF},
    {0x01, 0x01, 0x02, 0x07, 0x00, 0xBB, 0xCC},
    {0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x07},
    {0x01, 0x46, 0x00, 0x12, 0x60},
    {0x01, 0x46, 0x00, 0x00, 0x90, 0x42, 0x00, 0x35, 0xEB},
    {0x01, 0x11, 0xC0, 0x2C},
    {0x01, 0x11, 0x08, 0x90, 0x42, 0xFF, 0x39, 0x30, 0x34, 0x32, 0x4D, 0x4D, 0x71},
};

TEST(Crc16, TheCrcOfNoBytesIsFFFF) { EXPECT_EQ(Crc16().value(), 0xFFFF); }

TEST(Crc16, TheCheckValueIs4B37) {
  Crc16 crc;
  for (const char digit : std::string_view("123456789")) {
    crc.add(static_cast<std::uint8_t>(digit));
  }
  EXPECT_EQ(crc.value(), 0x4B37);
}

TEST(Crc16, TheCrcOfTheExampleInTheSerialLineGuideIs1241) {
  const Crc16 crc = crc_of({0x02, 0x07});
  EXPECT_EQ(crc.value(), 0x1241);
  EXPECT_EQ(crc.low_byte(), 0x41);
  EXPECT_EQ(crc.high_byte(), 0x12);
}

TEST(Crc16, TheCrcOfSwitchingChannel0OnIs3A8C) {
  EXPECT_EQ(crc_of({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00}).value(), 0x3A8C);
}

TEST(Crc16, IsSentLowByteFirstInEveryExampleFrame) {
  for (const FrameBytes& frame : kWorkedFrames) {
    const Crc16 crc = crc16({frame.data(), frame.size() - 2});
    EXPECT_EQ(crc.low_byte(), frame[frame.size() - 2]) << "function " << int{frame[1]};
    EXPECT_EQ(crc.high_byte(), frame[frame.size() - 1]) << "function " << int{frame[1]};
  }
}

TEST(Crc16, IsZeroOverAFrameWithItsCrc) {
  for (const FrameBytes& frame : kWorkedFrames) {
    EXPECT_EQ(crc_of(frame).value(), 0) << "function " << int{frame[1]};
  }
}

// The expected value is the remainder of a division of the frame by x^16 + x^15 + x^2 + 1 as a row of bits.
TEST(Crc16, TheCrcOfALongestFrameIs5639) {
  FrameBytes frame;
  for (unsigned i = 0; i < 254; ++i) {
    frame.push_back(static_cast<std::uint8_t>(i * 7 + 3));
  }
  EXPECT_EQ(crc_of(frame).value(), 0x5639);
}

TEST(Crc16, IsNotZeroOverAFrameWhoseCrcHasItsHighByteFirst) {
  EXPECT_NE(crc_of({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x3A, 0x8C}).value(), 0);
}

TEST(Crc16, DetectsEverySingleAndDoubleBitErrorInAFrameOf8Bytes) {
  const FrameBytes frame = kWorkedFrames[0];
  const std::size_t bits = frame.size() * 8;
  const auto flip = [](FrameBytes& bytes, std::size_t bit) {
    bytes[bit / 8] = static_cast<std::uint8_t>(bytes[bit / 8] ^ (1U << (bit % 8)));
  };
  for (std::size_t first = 0; first < bits; ++first) {
    FrameBytes once = frame;
    flip(once, first);
    EXPECT_NE(crc_of(once).value(), 0) << "bit " << first;
    for (std::size_t second = first + 1; second < bits; ++second) {
      FrameBytes twice = once;
      flip(twice, second);
      EXPECT_NE(crc_of(twice).value(), 0) << "bits " << first << " and " << second;
    }
  }
}

TEST(Crc16, CanBeComputedAtCompileTime) {
  constexpr std::uint8_t kFrame[] = {0x02, 0x07};
  static_assert(crc16({kFrame, 2}).value() == 0x1241);
}

}  // namespace
}  // namespace ex9000
