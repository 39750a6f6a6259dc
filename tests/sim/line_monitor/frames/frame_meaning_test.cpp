// Tests how the simulator detects that a frame is DCON, and the text, the meaning and the error that the log
// shows for a frame.
#include "sim/line_monitor/frames/frame_meaning.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

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
       {"#**\r", "$01M\r", "%0102400640\r", "@01\r", "~**\r", "!01400640\r", ">\r", "?01\r"}) {
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

TEST(LooksLikeDcon, IsTrueForAnIncompleteFrame) {
  EXPECT_TRUE(looks_like_dcon(dcon("$")));
  EXPECT_TRUE(looks_like_dcon(dcon("$01")));
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

TEST(Shown, DconFramesAreShownAsText) { EXPECT_EQ(shown(dcon("$01M\r")), "$01M\\r"); }

TEST(Shown, DconFramesWithoutACarriageReturnAreShownAsText) { EXPECT_EQ(shown(dcon("$01M")), "$01M"); }

TEST(Shown, OtherFramesAreShownInHex) {
  EXPECT_EQ(shown({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3A}), "01 05 00 00 FF 00 8C 3A");
  EXPECT_EQ(shown({0x00}), "00");
  EXPECT_EQ(shown({}), "");
}

// --- DCON ---

TEST(DconMeaning, ACommandIsNamedAsTheManualsWriteIt) {
  EXPECT_EQ(of_request("$012\r").find("$AA2: "), 0U);
  EXPECT_EQ(of_request("$01M\r").find("$AAM: "), 0U);
  EXPECT_EQ(of_request("#010B1F\r").find("#AABBDD: "), 0U);
  EXPECT_EQ(of_request("#013\r").find("#AAN: "), 0U);
  EXPECT_EQ(of_request("@01\r").find("@AA: "), 0U);
  EXPECT_EQ(of_request("@01FF\r").find("@AA(Data): "), 0U);
  EXPECT_EQ(of_request("$01C\r").find("$AAC: "), 0U);
  EXPECT_EQ(of_request("$01C3\r").find("$AACN: "), 0U);
  EXPECT_EQ(of_request("~013164\r").find("~AA3EVV: "), 0U);
  EXPECT_EQ(of_request("%0102400600\r").find("%AANNTTCCFF: "), 0U);
}

TEST(DconMeaning, ABroadcastIsNamed) {
  EXPECT_EQ(of_request("#**\r").find("#**: "), 0U);
  EXPECT_EQ(of_request("~**\r").find("~**: "), 0U);
  EXPECT_TRUE(has(of_request("~**\r"), "host"));
}

TEST(DconMeaning, ACommandWithAChecksumIsNamed) {
  EXPECT_EQ(of_request("$012B7\r").find("$AA2: "), 0U);
  EXPECT_EQ(of_request("~**D2\r").find("~**: "), 0U);
  EXPECT_EQ(of_request("#**77\r").find("#**: "), 0U);
}

TEST(DconMeaning, AWrongChecksumIsReported) {
  EXPECT_TRUE(has(of_request("$012B8\r"), ", wrong checksum"));
  EXPECT_EQ(check_error(dcon("$012B8\r"), Speaker::Master), "wrong checksum");
  EXPECT_EQ(check_error(dcon("$012B7\r"), Speaker::Master), "");
  EXPECT_EQ(check_error(dcon("~**D3\r"), Speaker::Master), "wrong checksum");
}

TEST(DconMeaning, NoWrongChecksumIsReportedIfTheFrameMayHaveNoChecksum) {
  EXPECT_EQ(check_error(dcon("@01FF\r"), Speaker::Master), "");
  EXPECT_EQ(check_error(dcon("$01Z\r"), Speaker::Master), "");
  EXPECT_EQ(check_error(dcon("$\r"), Speaker::Master), "");
  EXPECT_EQ(check_error(dcon("!01400600\r"), Speaker::Module), "");
}

TEST(DconMeaning, AnUnknownCommandIsReported) {
  EXPECT_EQ(of_request("$01Z\r"), "unknown command");
  EXPECT_EQ(of_request("$**\r"), "unknown command");
  EXPECT_EQ(of_request("%01\r"), "unknown command");
}

TEST(DconMeaning, AFrameTooShortForAnAddressHasNoMeaning) {
  EXPECT_EQ(of_request("$\r"), "");
  EXPECT_EQ(of_request("$0\r"), "");
}

TEST(DconMeaning, ARejectionTheReplyToAnIgnoredCommandAndOtherRepliesAreDistinguished) {
  EXPECT_EQ(of_reply("?01\r"), "rejected");
  EXPECT_EQ(of_reply("?\r"), "rejected");
  EXPECT_TRUE(has(of_reply("!\r"), "ignored"));
  EXPECT_EQ(of_reply("!0"), "reply");
  EXPECT_EQ(of_reply("!01400640\r"), "reply");
  EXPECT_EQ(of_reply(">\r"), "reply");
  EXPECT_EQ(of_reply(">0F00\r"), "reply");
}

// --- Modbus RTU ---

TEST(ModbusMeaning, ARequestIsShownWithItsFunctionAddressValueAndMeaning) {
  const std::string text = of_request(FrameBytes{0x01, 0x05, 0x00, 0x00, 0xFF, 0x00});
  EXPECT_EQ(text.find("01: Write Single Coil"), 0U) << text;
  EXPECT_TRUE(has(text, "0000 = FF00")) << text;
  EXPECT_TRUE(has(text, "outputs")) << text;
}

TEST(ModbusMeaning, ARangeIsShownWithItsQuantity) {
  const std::string text = of_request(FrameBytes{0x0A, 0x01, 0x00, 0x80, 0x00, 0x0D});
  EXPECT_EQ(text.find("0A: Read Coils"), 0U) << text;
  EXPECT_TRUE(has(text, "0080 x 13")) << text;
  EXPECT_TRUE(has(text, "safe value")) << text;
}

TEST(ModbusMeaning, TheMeaningNamesTheDataAtTheAddress) {
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x02, 0, 0, 0, 8}), "inputs"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x01, 0, 0x40, 0, 8}), "latch high"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x01, 0, 0x60, 0, 8}), "latch low"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x05, 0, 0xA0, 0, 0}), "power-on value"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x05, 1, 0x00, 0, 0}), "protocol"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x05, 1, 0x0D, 0xFF, 0}), "timeout status"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x04, 0, 7, 0, 1}), "counter"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x06, 1, 0xE4, 0, 5}), "address"));
  EXPECT_TRUE(has(of_request(FrameBytes{1, 0x10, 1, 0xE5, 0, 1, 2, 0, 6}), "baud"));
}

TEST(ModbusMeaning, ABroadcastIsShownAsARequestToAllModules) {
  EXPECT_EQ(of_request(FrameBytes{0x00, 0x05, 0x00, 0x00, 0xFF, 0x00}).find("all modules: "), 0U);
}

TEST(ModbusMeaning, AHostOkIsNamed) {
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x03, 0x30, 0x38, 0x00, 0x00}), "host OK"));
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x04, 0x30, 0x38, 0x00, 0x01}), "host OK"));
}

TEST(ModbusMeaning, ReadingRegister3038WithAnotherQuantityOrLengthIsNotAHostOk) {
  EXPECT_FALSE(has(of_request(FrameBytes{0x01, 0x03, 0x30, 0x38, 0x00, 0x02}), "host OK"));
  EXPECT_FALSE(has(of_request(FrameBytes{0x01, 0x03, 0x30, 0x38, 0x00, 0x01, 0x00}), "host OK"));
}

TEST(ModbusMeaning, AnAddressThatTheMapDoesNotListForTheFunctionIsReportedAsUnknown) {
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x01, 0x04, 0x00, 0x00, 0x01}), "unknown address"));
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x06, 0x01, 0xE2, 0x00, 0x01}), "unknown address"));
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x03, 0x00, 0x10, 0x00, 0x01}), "unknown address"));
}

TEST(ModbusMeaning, CoilsOfA17thInputAreUnknown) {
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x01, 0x00, 0x30, 0x00, 0x01}), "unknown address"));
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x05, 0x02, 0x10, 0xFF, 0x00}), "unknown address"));
}

TEST(ModbusMeaning, Functions08And11And46AreNamed) {
  EXPECT_EQ(of_request(FrameBytes{0x01, 0x46, 0x00}), "01: Module code and address");
  EXPECT_EQ(of_request(FrameBytes{0x01, 0x11}), "01: Report Server ID");
  EXPECT_EQ(of_request(FrameBytes{0x01, 0x08, 0x00, 0x0B, 0x00, 0x00}), "01: Diagnostics");
}

TEST(ModbusMeaning, AnUnknownFunctionIsShownInHex) {
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x41, 0x00, 0x00, 0x00, 0x00}), "function 41"));
}

TEST(ModbusMeaning, AnExceptionReplyIsShownWithItsCode) {
  const std::string text = of_reply(FrameBytes{0x01, 0x85, 0x04});
  EXPECT_TRUE(has(text, "Write Single Coil")) << text;
  EXPECT_TRUE(has(text, "exception 04")) << text;
}

TEST(ModbusMeaning, AFunctionWithTheExceptionBitIsAnExceptionOnlyInAReplyOfFiveBytes) {
  EXPECT_TRUE(has(of_request(FrameBytes{0x01, 0x81, 0x00, 0x00, 0x00, 0x01}), "function 81"));
  EXPECT_FALSE(has(of_reply(FrameBytes{0x01, 0x81}), "exception"));
}

TEST(ModbusMeaning, ANormalReplyIsNamedAsAReply) {
  EXPECT_EQ(of_reply(FrameBytes{0x01, 0x01, 0x02, 0x07, 0x00}), "01: Read Coils, reply");
}

TEST(ModbusMeaning, AShortFrameAndAWrongCrcAreReported) {
  EXPECT_EQ(meaning({0x01, 0x05, 0x00}, Speaker::Master), "too short for a frame");
  EXPECT_EQ(meaning({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B}, Speaker::Master), "wrong CRC");
  EXPECT_EQ(meaning({}, Speaker::Master), "too short for a frame");
}

}  // namespace
}  // namespace ex9000::sim
