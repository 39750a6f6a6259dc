// Tests the lines that the text log and the JSON log write for frames and notes, and the text of errors.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string_view>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/line_monitor/log/line_log.hpp"

namespace ex9000::sim {
namespace {

constexpr VirtualTime kBegan{12'345'678'901};

Frame frame_of(std::size_t station, FrameBytes bytes) {
  Frame frame;
  frame.station = station;
  frame.bytes = std::move(bytes);
  frame.began = kBegan;
  return frame;
}
Frame dcon(std::size_t station, std::string_view text) {
  return frame_of(station, {text.begin(), text.end()});
}

StationNames names() { return StationNames({"master", "01 EX9042D-M"}); }

std::string text_of(const Frame& frame) {
  std::string printed;
  text_log(names(), [&printed](const std::string& line) { printed += line + "|"; })->frame(frame);
  return printed;
}

std::string json_line_of(const Frame& frame) {
  std::string printed;
  json_log("pump", names(), [&printed](const std::string& line) { printed += line; })->frame(frame);
  return printed;
}
nlohmann::json json_of(const Frame& frame) { return nlohmann::json::parse(json_line_of(frame)); }

TEST(LineLog, ReportsTheBaudRateAndTheFormatOfAFrameThatReceiversInTheModeOfTheLineCannotRead) {
  Frame frame = frame_of(1, {1, 2, 3});
  frame.sent_in = {115200, LineFormat::k8N1};
  frame.line_in = {9600, LineFormat::k8N1};
  EXPECT_NE(text_of(frame).find("sent at 115200 baud 8N1 on a line at 9600 baud 8N1"), std::string::npos);
  frame.line_in = {115200, LineFormat::k8O1};
  EXPECT_NE(text_of(frame).find("sent at 115200 baud 8N1 on a line at 115200 baud 8O1"), std::string::npos);
  frame.line_in = {115200, LineFormat::k8N2};  // receivers check only the first stop bit
  EXPECT_EQ(text_of(frame).find("sent at"), std::string::npos);
}

TEST(LineLog, ReportsAParityErrorOfAChangedByte) {
  Frame frame = frame_of(1, {1, 2, 3});
  frame.changes.push_back({1, 0x02, levels_of(0x03, LineFormat::k8E1) ^ (1U << 9U), LineFormat::k8E1});
  frame.changes.push_back({2, 0x03, levels_of(0x03, LineFormat::k8O1), LineFormat::k8E1});
  EXPECT_NE(text_of(frame).find("byte 2: parity error, 03 instead of 02; byte 3: parity error"),
            std::string::npos);
}

TEST(TextLog, AFrameIsPrintedOnOneLine) {
  EXPECT_EQ(text_of(frame_of(0, with_crc({1, 5, 0, 2, 0xFF, 0}))),
            "   12.345679  > master  01 05 00 02 FF 00 2D FA  ; 01: Write Single Coil 0002 = FF00, outputs|");
  EXPECT_EQ(text_of(dcon(1, ">0004\r")), "   12.345679  < 01 EX9042D-M  >0004\\r  ; reply|");
}

TEST(TextLog, ACollidedFrameHasNoMeaning) {
  Frame frame = frame_of(1, {1, 2, 3});
  frame.collided = true;
  EXPECT_EQ(text_of(frame),
            "   12.345679  < 01 EX9042D-M  01 02 03  ; collision: another station drove the line at the same "
            "time|");
}

TEST(TextLog, ChangesByNoiseAreReportedBeforeAWrongCrc) {
  Frame frame = frame_of(1, {1, 2, 3, 4});
  frame.changes.push_back({2, 0x07, levels_of(0x03)});
  EXPECT_EQ(text_of(frame),
            "   12.345679  < 01 EX9042D-M  01 02 03 04  ; noise: byte 3: 03 instead of 07; wrong CRC|");
}

TEST(TextLog, ANoteIsPrintedOnOneLine) {
  std::string printed;
  text_log(names(), [&printed](const std::string& line) { printed = line; })->note(kBegan, "a remark");
  EXPECT_EQ(printed, "   12.345679  - a remark");
}

TEST(TextLog, AFrameFromAnUnknownSenderHasNoMeaning) {
  EXPECT_EQ(text_of(frame_of(5, {1, 2, 3})), "   12.345679  ? unknown sender  01 02 03|");
}

TEST(JsonLog, AFrameIsAnObjectWithItsKeysInOrder) {
  EXPECT_EQ(json_line_of(frame_of(0, with_crc({1, 5, 0, 2, 0xFF, 0}))),
            R"({"time":12.345678901,"line":"pump","from":"master","bytes":"01050002FF002DFA",)"
            R"("meaning":"01: Write Single Coil 0002 = FF00, outputs","collided":false})");
}

TEST(JsonLog, ADconFrameHasItsTextInAdditionToItsBytes) {
  EXPECT_EQ(json_line_of(dcon(1, "!01\"\\\r")),
            R"({"time":12.345678901,"line":"pump","from":"01 EX9042D-M","bytes":"213031225C0D",)"
            R"("text":"!01\"\\\r","meaning":"reply","collided":false})");
}

TEST(JsonLog, ErrorsAndCollisionsAreReported) {
  Frame frame = frame_of(1, {1, 2, 3, 4});
  frame.changes.push_back({2, 0x07, levels_of(0x03)});
  EXPECT_EQ(json_of(frame)["error"], "noise: byte 3: 03 instead of 07; wrong CRC");
  frame.collided = true;
  EXPECT_EQ(json_of(frame)["collided"], true);
  EXPECT_EQ(json_of(frame)["error"],
            "collision: another station drove the line at the same time; noise: byte 3: 03 instead of 07");
  EXPECT_FALSE(json_of(frame).contains("meaning"));
}

TEST(JsonLog, AFrameFromAnUnknownSenderHasNoMeaning) {
  EXPECT_EQ(
      json_line_of(frame_of(5, {1, 2, 3})),
      R"({"time":12.345678901,"line":"pump","from":"unknown sender","bytes":"010203","collided":false})");
}

TEST(JsonLog, ANoteHasItsTimeAndLine) {
  std::string printed;
  json_log("pump", names(), [&printed](const std::string& line) {
    printed = line;
  })->note(kBegan, "at \"9600\"\nbaud");
  EXPECT_EQ(printed, R"({"time":12.345678901,"line":"pump","note":"at \"9600\"\nbaud"})");
}

TEST(JsonLog, ALineNameThatIsNotUtf8StillGivesValidJson) {
  std::string printed;
  json_log("p\xFFmp", names(), [&printed](const std::string& line) { printed = line; })->note(kBegan, "");
  EXPECT_EQ(nlohmann::json::parse(printed)["line"], "p\xEF\xBF\xBDmp");
}

TEST(LineError, ListsEachChangedByteWithItsPosition) {
  Frame frame;
  EXPECT_EQ(line_error(frame), "");
  frame.changes.push_back({0, 0x41, levels_of(0x43)});
  frame.changes.push_back({4, 0x41, kIdleLevels});
  frame.changes.push_back({9, 0x41, levels_of(0x61) & 0x1FFU});
  frame.changes.push_back({10, 0x41, 0});
  EXPECT_EQ(line_error(frame),
            "noise: byte 1: 43 instead of 41; byte 5: 41 is lost because its start bit is missing; "
            "byte 10: framing error, 61 instead of 41; byte 11: break instead of 41");
}

TEST(LineError, ValidFramesAndASingleLineFeedHaveNoError) {
  EXPECT_EQ(errors(frame_of(0, with_crc({1, 5, 0, 2, 0xFF, 0}))), "");
  EXPECT_EQ(errors(dcon(0, "$012B7\r")), "");
  EXPECT_EQ(errors(frame_of(0, {0x0A})), "");
}

}  // namespace
}  // namespace ex9000::sim
