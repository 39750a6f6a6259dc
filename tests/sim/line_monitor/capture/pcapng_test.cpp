// Tests the blocks of a capture against the draft of the pcapng format. Tests the header of a frame in
// Wireshark's own link type, Upper PDU.
#include "sim/line_monitor/capture/pcapng.hpp"

#include <gtest/gtest.h>

#include <string>

#include "sim/line_monitor/capture/upper_pdu.hpp"

namespace ex9000::sim {
namespace {

std::string hex(const std::vector<std::uint8_t>& bytes) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    text += i % 4 == 0 && i != 0 ? " " : "";
    text += kDigits[bytes[i] / 16];
    text += kDigits[bytes[i] % 16];
  }
  return text;
}

TEST(Pcapng, ASectionHeaderContainsTheVersionAndTheNameOfTheProgram) {
  // The first line of hex digits contains the block type, the block length, the byte-order magic, the
  // version 1.0, and the code for an unknown section length.
  EXPECT_EQ(hex(pcapng::section_header("abcde")),
            "0A0D0D0A 2C000000 4D3C2B1A 01000000 FFFFFFFF FFFFFFFF "
            "04000500 61626364 65000000 00000000 2C000000");
}

TEST(Pcapng, AnInterfaceHasANameAndATimestampResolutionOfOneNanosecond) {
  EXPECT_EQ(hex(pcapng::interface_description(252, "com1")),
            "01000000 28000000 FC000000 00000000 02000400 636F6D31 09000100 09000000 00000000 28000000");
}

TEST(Pcapng, APacketHasATimeADirectionAndAnInterface) {
  pcapng::EnhancedPacket packet;
  packet.interface_id = 2;
  packet.timestamp = std::chrono::nanoseconds(0x0123456789ABCDEF);
  packet.direction = pcapng::Direction::Outbound;
  packet.data = {1, 2, 3, 4, 5};
  EXPECT_EQ(hex(pcapng::enhanced_packet(packet)),
            "06000000 34000000 02000000 67452301 EFCDAB89 05000000 05000000 01020304 05000000 "
            "02000400 02000000 00000000 34000000");
}

TEST(Pcapng, ACommentIsAnOptionOfItsPacket) {
  pcapng::EnhancedPacket packet;
  packet.comment = "bad";
  EXPECT_EQ(hex(pcapng::enhanced_packet(packet)),
            "06000000 34000000 00000000 00000000 00000000 00000000 00000000 "
            "02000400 01000000 01000300 62616400 00000000 34000000");
}

TEST(Pcapng, ACommentIsCutToTheMaximumOptionLength) {
  pcapng::EnhancedPacket packet;
  packet.comment = std::string(70'000, 'x');
  const pcapng::Block block = pcapng::enhanced_packet(packet);
  EXPECT_EQ(block.size(), 28U + 8U + 4U + 65'536U + 4U + 4U);
  EXPECT_EQ(hex({block.begin() + 36, block.begin() + 40}), "0100FFFF");
}

TEST(UpperPdu, NamesTheDissectorThePortsAndTheProtocol) {
  EXPECT_EQ(hex(UpperPdu{"mbrtu", "Modbus RTU", 0x1234, 0x5678}.header()),
            "000C0008 6D627274 75000000 00180004 00000002 00190004 00001234 001A0004 00005678 "
            "0021000C 4D6F6462 75732052 54550000 00000000");
}

TEST(UpperPdu, ATextOfFourBytesHasNoPadding) {
  EXPECT_EQ(
      hex(UpperPdu{"data", "DCON", 1, 2}.header()),
      "000C0004 64617461 00180004 00000002 00190004 00000001 001A0004 00000002 00210004 44434F4E 00000000");
}

}  // namespace
}  // namespace ex9000::sim
