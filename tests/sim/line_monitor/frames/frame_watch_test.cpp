// Tests which bytes on the line form one frame.
#include "sim/line_monitor/frames/frame_watch.hpp"

#include <gtest/gtest.h>

#include <string_view>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/virtual_line/wires/master.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t kBaud = 9600;
constexpr VirtualTime kCharacter{1'041'667};
constexpr std::size_t kMaster = 0;
constexpr std::size_t kModule = 1;

FrameBytes dcon(std::string_view text) { return {text.begin(), text.end()}; }

class FrameWatchTest : public testing::Test {
 protected:
  FrameWatchTest() {
    watch.add_receiver([this](const Frame& frame) { frames.push_back(frame); });
  }

  void send(std::size_t station, const FrameBytes& bytes, bool collided = false) {
    for (const std::uint8_t byte : bytes) {
      watch.byte(station, byte, sender_mode, collided, now, now + kCharacter);
      now += kCharacter;
    }
  }
  void send_changed(std::size_t station, std::uint8_t byte, Levels arrives) {
    watch.changed(station, arrives);
    send(station, {byte});
  }
  void pass(VirtualTime time) {
    now += time;
    watch.run(now);
  }

  SerialMode sender_mode{kBaud};
  SerialMode line_mode{kBaud};
  FrameWatch watch{[this] { return line_mode; }};
  std::vector<Frame> frames;
  VirtualTime now{0};
};

TEST_F(FrameWatchTest, AModulesFrameEndsWhenItsDriverIsDisabled) {
  watch.driver(kModule, true, now);
  send(kModule, {1, 2, 3});
  EXPECT_TRUE(frames.empty());
  watch.driver(kModule, false, now);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].station, kModule);
  EXPECT_EQ(frames[0].speaker(), Speaker::Module);
  EXPECT_EQ(frames[0].bytes, (FrameBytes{1, 2, 3}));
  EXPECT_FALSE(frames[0].collided);
  EXPECT_TRUE(frames[0].changes.empty());
  EXPECT_EQ(frames[0].began, VirtualTime(0));
  EXPECT_EQ(frames[0].ended, 3 * kCharacter);
}

TEST_F(FrameWatchTest, PiecesFromTheMasterAreOneFrameIfTheGapBetweenThemIsShort) {
  send(kMaster, {1, 5});
  watch.driver(kMaster, false, now);
  pass(milliseconds(4));
  send(kMaster, {0, 2});
  pass(milliseconds(4));
  EXPECT_TRUE(frames.empty());
  pass(milliseconds(2));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, (FrameBytes{1, 5, 0, 2}));
  EXPECT_EQ(frames[0].speaker(), Speaker::Master);
}

TEST_F(FrameWatchTest, TheMastersFrameEndsWhenAModuleReplies) {
  send(kMaster, {1, 5});
  watch.driver(kModule, true, now);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, (FrameBytes{1, 5}));
}

TEST_F(FrameWatchTest, UnansweredRequestsAreSeparateFrames) {
  const FrameBytes request = with_crc({0, 5, 0, 2, 0xFF, 0});
  send(kMaster, request);
  pass(microseconds(3700));  // more than 3.5 characters of ten bits
  send(kMaster, request);
  EXPECT_EQ(frames.size(), 1U);
  watch.finish();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].bytes, request);
  EXPECT_EQ(frames[1].bytes, request);
}

// The shortest request has four bytes: the address, the function and the CRC (Modbus over Serial Line V1.02,
// 2.3).
TEST_F(FrameWatchTest, AnUnansweredRequestOfFourBytesIsAFrame) {
  send(kMaster, with_crc({5, 7}));
  pass(microseconds(3700));
  send(kMaster, with_crc({5, 7}));
  EXPECT_EQ(frames.size(), 1U);
}

TEST_F(FrameWatchTest, ACorrectCrcBeforeAShortGapDoesNotEndAFrame) {
  const FrameBytes request = with_crc({0, 5, 0, 2, 0xFF, 0});
  send(kMaster, request);
  pass(microseconds(1500));
  send(kMaster, {0x55});
  watch.finish();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes.size(), request.size() + 1);
}

TEST_F(FrameWatchTest, ACarriageReturnEndsADconFrame) {
  send(kMaster, dcon("$01M\r$02M\r"));
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].bytes, dcon("$01M\r"));
  EXPECT_EQ(frames[1].bytes, dcon("$02M\r"));
  EXPECT_EQ(frames[1].began, 5 * kCharacter);
}

TEST_F(FrameWatchTest, AnIncompleteDconCommandEndsAfterFiveSecondsWithoutAByte) {
  send(kMaster, dcon("$01"));
  pass(seconds(4));
  watch.driver(kModule, true, now);
  watch.driver(kModule, false, now);
  EXPECT_TRUE(frames.empty());
  send(kMaster, dcon("M\r"));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, dcon("$01M\r"));
  send(kMaster, dcon("$01"));
  EXPECT_EQ(watch.next(), now + seconds(5));
  pass(seconds(5));
  EXPECT_EQ(frames.size(), 2U);
  EXPECT_EQ(watch.next(), hal::doubles::kNever);
}

TEST_F(FrameWatchTest, AFrameOfMoreThan300BytesIsReportedInPieces) {
  send(kMaster, FrameBytes(700, 0x55));
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].bytes.size(), 300U);
}

TEST_F(FrameWatchTest, AByteWithoutItsStartBitDoesNotArrive) {
  send(kModule, {0x10});
  send_changed(kModule, 0x41, levels_of(0x41) | 1U);
  send_changed(kModule, 0x42, kIdleLevels);
  send(kModule, {0x13});
  watch.driver(kModule, false, now);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, (FrameBytes{0x10, 0x13}));
  ASSERT_EQ(frames[0].changes.size(), 2U);
  EXPECT_EQ(frames[0].changes[1].position, 2U);
  EXPECT_FALSE(frames[0].changes[0].byte());
  EXPECT_FALSE(frames[0].changes[1].byte());
}

TEST_F(FrameWatchTest, AFrameIsReportedEvenIfAllItsBytesAreLost) {
  send_changed(kModule, 0x41, kIdleLevels);
  watch.driver(kModule, false, now);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].bytes.empty());
  EXPECT_EQ(frames[0].changes.size(), 1U);
}

TEST_F(FrameWatchTest, AChangeOfTheLineFormatDuringAFrameIsNotReportedAsNoise) {
  for (const LineFormat format :
       {LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1, LineFormat::k8O1, LineFormat::k8N1}) {
    line_mode.format = format;
    sender_mode.format = format;
    send(kMaster, {0x31});
  }
  watch.finish();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, (FrameBytes{0x31, 0x31, 0x31, 0x31, 0x31}));
  EXPECT_EQ(line_error(frames[0]), "");
}

TEST_F(FrameWatchTest, AByteThatTheMasterSendsWithWrongParityHasAParityError) {
  hal::doubles::VirtualClock clock;
  Wires bus(clock);
  bus.observe(watch);
  Master master(bus, {kBaud, LineFormat::k8E1}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  line_mode = master.mode();
  const FrameBytes sent{0x01, 0x05, 0x07};
  master.send(sent.data(), sent.size(), VirtualTime(0), {0, 2});
  bus.run_for(milliseconds(10));
  watch.finish();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, sent);
  EXPECT_EQ(line_error(frames[0]), "noise: byte 1: parity error; byte 3: parity error");
}

TEST_F(FrameWatchTest, AChangeOfAnAbortedByteDoesNotAffectALaterByte) {
  watch.changed(kModule, kIdleLevels);
  watch.driver(kModule, false, now);
  send(kModule, {0x41});
  watch.finish();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, (FrameBytes{0x41}));
}

// extensions.md, scan. At 9600 baud, a window is three bits longer than a byte.
TEST_F(FrameWatchTest, TheBytesOfAnArbitrationAreOneFrameWithAByteForEachWindow) {
  constexpr std::size_t kOther = 2;
  constexpr VirtualTime kWindow{1'354'167};
  const auto burst = [this](std::size_t station, VirtualTime late) {
    watch.byte(station, 0xFF, sender_mode, true, now + late, now + late + kCharacter);
    watch.driver(station, false, now + late + kCharacter);
  };
  burst(kModule, microseconds(0));
  burst(kOther, microseconds(3));
  now += 5 * kWindow;
  burst(kModule, microseconds(0));
  now += kWindow;
  EXPECT_TRUE(frames.empty());
  send(kModule, with_crc({0xFD, 0x46, 0x04}));
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].bytes, (FrameBytes{0xFF, 0xFF}));
  EXPECT_EQ(frames[0].station, kModule);
  EXPECT_EQ(frames[0].skew, microseconds(3));
  EXPECT_EQ(errors(frames[0]), "");
  watch.driver(kModule, false, now);
  frames.clear();

  burst(kModule, microseconds(0));
  burst(kOther, microseconds(320));
  pass(50 * kWindow);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(errors(frames[0]), "modules begin the same window 320us apart, so that not all bytes end in it");
}

}  // namespace
}  // namespace ex9000::sim
