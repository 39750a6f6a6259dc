// Tests how bytes with line errors (wrong parity or a framing error) are distinguished from other bytes:
// POSIX.1-2017, 11.2.2, PARMRK.
#include "sim/files_and_ports/ports/parity_marks.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace ex9000::sim {
namespace {

using Arrived = std::vector<ParityMarks::Arrived>;

Arrived read(ParityMarks& marks, const std::vector<std::uint8_t>& bytes) {
  return marks.read(bytes.data(), bytes.size());
}

TEST(ParityMarks, BytesWithoutAMarkAreGood) {
  ParityMarks marks;
  EXPECT_EQ(read(marks, {0x00, 0x31, 0xFE}), (Arrived{{0x00, false}, {0x31, false}, {0xFE, false}}));
}

TEST(ParityMarks, AMarkedByteIsDamaged) {
  ParityMarks marks;
  EXPECT_EQ(read(marks, {0x24, 0xFF, 0x00, 0x31, 0x0D}),
            (Arrived{{0x24, false}, {0x31, true}, {0x0D, false}}));
  EXPECT_EQ(read(marks, {0xFF, 0x00, 0xFF, 0xFF, 0x00, 0x00}), (Arrived{{0xFF, true}, {0x00, true}}));
}

TEST(ParityMarks, ADoubleMarkIsAGoodByteFF) {
  ParityMarks marks;
  EXPECT_EQ(read(marks, {0xFF, 0xFF, 0xFF, 0xFF, 0x01}),
            (Arrived{{0xFF, false}, {0xFF, false}, {0x01, false}}));
}

TEST(ParityMarks, AMarkMayBeSplitBetweenReads) {
  ParityMarks marks;
  EXPECT_EQ(read(marks, {0x01, 0xFF}), (Arrived{{0x01, false}}));
  EXPECT_EQ(read(marks, {0x00}), Arrived());
  EXPECT_EQ(read(marks, {0x02, 0x03}), (Arrived{{0x02, true}, {0x03, false}}));
}

}  // namespace
}  // namespace ex9000::sim
