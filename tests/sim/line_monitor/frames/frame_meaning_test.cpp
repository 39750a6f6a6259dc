// Tests how the simulator detects that a frame is DCON, and the text, the meaning and the error that the log
// shows for a frame.
#include "sim/line_monitor/frames/frame_meaning.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"

namespace ex9000::sim {
namespace {

FrameBytes dcon(std::string_view text) { return {text.begin(), text.end()}; }

FrameBytes rtu(const FrameBytes& bytes) { return with_crc(bytes); }

std::string of_request(std::string_view text) { return meaning(dcon(text), Speaker::Master); }
std::string of_reply(std::string_view text) { return meaning(dcon(text), Speaker::Module); }
std::string of_request(const FrameBytes& bytes) { return meaning(rtu(bytes), Speaker::Master); }
std::string of_reply(const FrameBytes& bytes) { return meaning(rtu(bytes), Speaker::Module); }

bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

// --- detection of the protocol ---

TEST(LooksLikeDcon, IsTrueForADelimiterOrReplyCharacterBeforePrintableText) {
  for (const char* text :
       {"#**\r", "$01M\r", "%0102400640\r", "@01\r", "~**\r", "!01400640\r", ">\r", "?01\r", "$", "$01"}) {
    EXPECT_TRUE(looks_like_dcon(dcon(text))) << text;
  }
}

TEST(LooksLikeDcon, IgnoresZeroBytesAndALineFeedBeforeADelimiter) {
  const FrameBytes behind_line_feed = dcon("\n$01M\r");
  EXPECT_TRUE(looks_like_dcon(behind_line_feed));
  EXPECT_EQ(shown(behind_line_feed), "\\n$01M\\r");
  EXPECT_EQ(meaning(behind_line_feed, Speaker::Master), meaning(dcon("$01M\r"), Speaker::Master));
  FrameBytes behind_turn_around = dcon("$01M\r");
  behind_turn_around.insert(behind_turn_around.begin(), 2, 0x00);
  EXPECT_TRUE(looks_like_dcon(behind_turn_around));
  EXPECT_EQ(shown(behind_turn_around), "\\0\\0$01M\\r");
  EXPECT_EQ(check_error(behind_turn_around, Speaker::Master), "");
  EXPECT_FALSE(looks_like_dcon(dcon("\n")));
  EXPECT_FALSE(looks_like_dcon(dcon("\n!01\r")));
  EXPECT_FALSE(looks_like_dcon(rtu({0x0A, 0x24, 0x00, 0x00})));
}

TEST(WasDcon, IsTrueForADconFrameEvenIfItIsIncompleteOrDamagedInTheMiddle) {
  EXPECT_TRUE(was_dcon(dcon("$01M\r")));
  EXPECT_TRUE(was_dcon(dcon("$01")));
  EXPECT_TRUE(was_dcon(dcon("$0\xB1M\r")));
  EXPECT_TRUE(was_dcon(dcon("!01\x05\r")));
  EXPECT_EQ(meaning(dcon("$0\xB1M\r"), Speaker::Master), "contains characters that are not printable");
}

TEST(WasDcon, IsFalseForOtherFrames) {
  EXPECT_FALSE(was_dcon({}));
  EXPECT_FALSE(was_dcon(dcon("$0\xB1M")));
  EXPECT_FALSE(was_dcon(dcon("\x01\x05\r")));
  const FrameBytes modbus = rtu({0x24, 0x06, 0x01, 0xE8, 0x00, 0x59});
  EXPECT_EQ(modbus.back(), '\r');
  EXPECT_FALSE(was_dcon(modbus));
}

TEST(LooksLikeDcon, IsFalseForOtherFrames) {
  EXPECT_FALSE(looks_like_dcon({}));
  EXPECT_FALSE(looks_like_dcon(dcon("01M\r")));
  EXPECT_FALSE(looks_like_dcon(dcon("\r")));
  EXPECT_FALSE(looks_like_dcon(dcon("$01\x01\r")));
  EXPECT_FALSE(looks_like_dcon(dcon("$01\rM\r")));
  EXPECT_FALSE(looks_like_dcon(rtu({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00})));
  EXPECT_FALSE(looks_like_dcon(rtu({0x24, 0x05, 0x00, 0x00, 0xFF, 0x00})));
}

// --- text for people ---

TEST(Shown, DconFramesAreShownAsTextAndOtherFramesInHex) {
  EXPECT_EQ(shown(dcon("$01M\r")), "$01M\\r");
  EXPECT_EQ(shown(dcon("$01M")), "$01M");
  EXPECT_EQ(shown({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3A}), "01 05 00 00 FF 00 8C 3A");
  EXPECT_EQ(shown({0x00}), "00");
  EXPECT_EQ(shown({}), "");
}

// --- DCON ---

TEST(DconMeaning, ACommandIsNamedAsTheManualsWriteIt) {
  for (const auto& [command, named] : std::vector<std::pair<const char*, const char*>>{
           {"$012\r", "$AA2: "},
           {"$01M\r", "$AAM: "},
           {"#010B1F\r", "#AABBDD: "},
           {"#013\r", "#AAN: "},
           {"@01\r", "@AA: "},
           {"@01FF\r", "@AA(Data): "},
           {"$01C\r", "$AAC: "},
           {"$01C3\r", "$AACN: "},
           {"~013164\r", "~AA3EVV: "},
           {"%0102400600\r", "%AANNTTCCFF: "},
           {"#**\r", "#**: "},
           {"~**\r", "~**: "},
           {"$012B7\r", "$AA2: "},  // with a checksum
           {"~**D2\r", "~**: "},
           {"#**77\r", "#**: "},
           {"$01Z\r", "unknown command"},
           {"$**\r", "unknown command"},
           {"%01\r", "unknown command"},
       }) {
    EXPECT_EQ(of_request(command).find(named), 0U) << command << of_request(command);
  }
  EXPECT_EQ(of_request("$\r"), "");  // too short for an address
  EXPECT_EQ(of_request("$0\r"), "");
}

TEST(DconMeaning, AWrongChecksumIsReportedUnlessTheFrameMayHaveNone) {
  EXPECT_TRUE(has(of_request("$012B8\r"), ", wrong checksum"));
  EXPECT_EQ(check_error(dcon("$012B8\r"), Speaker::Master), "wrong checksum");
  EXPECT_EQ(check_error(dcon("~**D3\r"), Speaker::Master), "wrong checksum");
  for (const char* command : {"$012B7\r", "@01FF\r", "$01Z\r", "$\r"}) {
    EXPECT_EQ(check_error(dcon(command), Speaker::Master), "") << command;
  }
  EXPECT_EQ(check_error(dcon("!01400600\r"), Speaker::Module), "");
}

TEST(DconMeaning, ARejectionTheReplyToAnIgnoredCommandAndOtherRepliesAreDistinguished) {
  for (const auto& [reply, means] : std::vector<std::pair<const char*, const char*>>{
           {"?01\r", "rejected"},
           {"?\r", "rejected"},
           {"!\r", "ignored"},
           {"!0", "reply"},
           {"!01400640\r", "reply"},
           {">\r", "reply"},
           {">0F00\r", "reply"},
       }) {
    EXPECT_TRUE(has(of_reply(reply), means)) << reply << of_reply(reply);
  }
}

// --- Modbus RTU ---

TEST(ModbusMeaning, ARequestIsShownWithItsFunctionItsAddressesItsValueAndItsMeaning) {
  for (const auto& [request, means] : std::vector<std::pair<FrameBytes, std::vector<const char*>>>{
           {{0x01, 0x05, 0, 0, 0xFF, 0}, {"01: Write Single Coil", "0000 = FF00", "outputs"}},
           {{0x0A, 0x01, 0, 0x80, 0, 0x0D}, {"0A: Read Coils", "0080 x 13", "safe value"}},
           {{0x00, 0x05, 0, 0, 0xFF, 0}, {"all modules: "}},
           {{1, 0x02, 0, 0, 0, 8}, {"inputs"}},
           {{1, 0x01, 0, 0x40, 0, 8}, {"latch high"}},
           {{1, 0x01, 0, 0x60, 0, 8}, {"latch low"}},
           {{1, 0x05, 0, 0xA0, 0, 0}, {"power-on value"}},
           {{1, 0x05, 1, 0x00, 0, 0}, {"protocol"}},
           {{1, 0x05, 1, 0x0D, 0xFF, 0}, {"timeout status"}},
           {{1, 0x04, 0, 7, 0, 1}, {"counter"}},
           {{1, 0x06, 1, 0xE4, 0, 5}, {"address"}},
           {{1, 0x10, 1, 0xE5, 0, 1, 2, 0, 6}, {"baud"}},
           {{1, 0x03, 0x30, 0x38, 0, 0}, {"host OK"}},
           {{1, 0x04, 0x30, 0x38, 0, 1}, {"host OK"}},
           {{1, 0x01, 4, 0, 0, 1}, {"unknown address"}},
           {{1, 0x06, 1, 0xE2, 0, 1}, {"unknown address"}},  // can only be read
           {{1, 0x03, 0, 0x10, 0, 1}, {"unknown address"}},
           {{1, 0x01, 0, 0x30, 0, 1}, {"unknown address"}},  // a 17th input
           {{1, 0x05, 2, 0x10, 0xFF, 0}, {"unknown address"}},
           {{1, 0x46, 0}, {"01: Module code and address"}},
           {{1, 0x11}, {"01: Report Server ID"}},
           {{1, 0x08, 0, 0x0B, 0, 0}, {"01: Diagnostics"}},
           {{1, 0x41, 0, 0, 0, 0}, {"function 41"}},
           {{1, 0x81, 0, 0, 0, 1}, {"function 81"}},  // an exception only in a reply of five bytes
       }) {
    for (const char* part : means) {
      EXPECT_TRUE(has(of_request(request), part)) << part << " in " << of_request(request);
    }
  }
  EXPECT_FALSE(has(of_request(FrameBytes{0x01, 0x03, 0x30, 0x38, 0x00, 0x02}), "host OK"));
  EXPECT_FALSE(has(of_request(FrameBytes{0x01, 0x03, 0x30, 0x38, 0x00, 0x01, 0x00}), "host OK"));
}

TEST(ModbusMeaning, AReplyAndAnExceptionAreShownWithTheirFunction) {
  EXPECT_EQ(of_reply(FrameBytes{0x01, 0x01, 0x02, 0x07, 0x00}), "01: Read Coils, reply");
  const std::string exception = of_reply(FrameBytes{0x01, 0x85, 0x04});
  EXPECT_TRUE(has(exception, "Write Single Coil")) << exception;
  EXPECT_TRUE(has(exception, "exception 04")) << exception;
  EXPECT_FALSE(has(of_reply(FrameBytes{0x01, 0x81}), "exception"));
}

TEST(ModbusMeaning, AShortFrameAndAWrongCrcAreReported) {
  EXPECT_EQ(meaning({0x01, 0x05, 0x00}, Speaker::Master), "too short for a frame");
  EXPECT_EQ(meaning({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B}, Speaker::Master), "wrong CRC");
  EXPECT_EQ(meaning({}, Speaker::Master), "too short for a frame");
}

// extensions.md, scan.
TEST(ScanMeaning, FramesAtAddressFDAreNamedAndRequestsBySerialNumberAreLikeOthers) {
  EXPECT_EQ(of_request(FrameBytes{0xFD, 0x46, 0x01}), "scan, first round");
  EXPECT_EQ(of_request(FrameBytes{0xFD, 0x46, 0x02}), "scan, next round");
  EXPECT_EQ(of_reply(FrameBytes{0xFD, 0x46, 0x03, 0x0D, 0x00, 0x12, 0x34, 0x2A}),
            "scan: 0D001234 at address 2A");
  EXPECT_EQ(of_reply(FrameBytes{0xFD, 0x46, 0x04}), "scan: nobody is left");
  EXPECT_EQ(of_request(FrameBytes{0xFD, 0x46, 0x08, 0x0D, 0x00, 0x12, 0x34, 0x05, 0, 0, 0xFF, 0}),
            "0D001234: Write Single Coil 0000 = FF00, outputs");
  EXPECT_EQ(of_reply(FrameBytes{0xFD, 0x46, 0x09, 0x0D, 0x00, 0x12, 0x34, 0x85, 0x04}),
            "0D001234: Write Single Coil, exception 04");
  EXPECT_EQ(of_request(FrameBytes{0xFD, 0x46, 0x05}), "FD: Module code and address");
  EXPECT_EQ(meaning(FrameBytes(22, 0xFF), Speaker::Module), "arbitration of a scan: a byte in 22 windows");
}

}  // namespace
}  // namespace ex9000::sim
