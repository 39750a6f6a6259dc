// Tests the frames of Modbus TCP. The layout of the header is from MODBUS Messaging on TCP/IP Implementation
// Guide V1.0b, 3.1.3.
#include "sim/front_ends/modbus_tcp/mbap.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace ex9000::sim {
namespace {

using Buffer = std::vector<std::uint8_t>;

/// Transaction 0x1234, unit 0x11, function 03.
const Buffer kRequest{0x12, 0x34, 0x00, 0x00, 0x00, 0x06, 0x11, 0x03, 0x01, 0xE8, 0x00, 0x01};

void add(MbapReader& reader, const Buffer& bytes) { reader.add({bytes.data(), bytes.size()}); }

Buffer header(unsigned protocol, unsigned length) {
  return {0x00,
          0x01,
          static_cast<std::uint8_t>(protocol >> 8U),
          static_cast<std::uint8_t>(protocol),
          static_cast<std::uint8_t>(length >> 8U),
          static_cast<std::uint8_t>(length),
          0x01};
}

TEST(MbapReader, TheReaderFindsBothFramesForEachSplitOfTheirBytesByTcp) {
  Buffer second = kRequest;
  second[1] = 0x35;
  Buffer both = kRequest;
  both.insert(both.end(), second.begin(), second.end());
  for (std::size_t split = 0; split <= both.size(); ++split) {
    MbapReader reader;
    const auto at = both.begin() + static_cast<std::ptrdiff_t>(split);
    std::vector<std::uint16_t> transactions;
    for (const Buffer& piece : {Buffer(both.begin(), at), Buffer(at, both.end())}) {
      add(reader, piece);
      while (const auto frame = reader.next()) {
        transactions.push_back(frame->transaction);
      }
    }
    EXPECT_EQ(transactions, (std::vector<std::uint16_t>{0x1234, 0x1235})) << split;
  }
}

TEST(MbapReader, OnlyLengthsFrom2To254AreValid) {
  for (unsigned length = 0; length <= 0xFFFF; ++length) {
    MbapReader reader;
    add(reader, header(0, length));
    const bool valid = length >= 2 && length <= 254;
    if (valid) {
      EXPECT_FALSE(reader.next()) << length;
      add(reader, Buffer(length - 1, 0x2A));
      const auto frame = reader.next();
      ASSERT_TRUE(frame) << length;
      EXPECT_EQ(frame->pdu, Buffer(length - 1, 0x2A));
    } else {
      EXPECT_FALSE(reader.next()) << length;
    }
    ASSERT_EQ(reader.broken(), !valid) << length;
  }
}

TEST(MbapReader, OnlyProtocol0IsModbus) {
  for (unsigned protocol = 0; protocol <= 0xFFFF; ++protocol) {
    MbapReader reader;
    Buffer bytes = header(protocol, 2);
    bytes.push_back(0x07);
    add(reader, bytes);
    EXPECT_EQ(reader.next().has_value(), protocol == 0) << protocol;
    ASSERT_EQ(reader.broken(), protocol != 0) << protocol;
  }
}

TEST(MbapBytes, AFrameIsWrittenWithItsHeader) {
  EXPECT_EQ(mbap_bytes({0x1234, 0x11, {0x03, 0x01, 0xE8, 0x00, 0x01}}), kRequest);
  const Buffer longest = mbap_bytes({1, 1, Buffer(253, 0x2A)});
  EXPECT_EQ(longest.size(), 260U);
  EXPECT_EQ(longest[4] * 256 + longest[5], 254);
}

}  // namespace
}  // namespace ex9000::sim
