// Tests what the receiver counts for Modbus function 08 (wire.md D1) and for the line tallies
// (firmware/extensions.md).
#include <gtest/gtest.h>

#include <cstdint>
#include <ostream>
#include <string_view>
#include <vector>

#include "firmware/line/receiver.hpp"
#include "tests/support/clock_at.hpp"

namespace ex9000 {
namespace {

using FrameBytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kOwn = 0x01;
constexpr std::uint32_t kBaud = 9600;
constexpr Duration kCharacter = Duration(1042);

/// The receiver's counters for function 08 (wire.md D1), in the order of the sub-functions 0B, 0C, 0E, 0F and
/// 12.
struct Counts {
  unsigned bus_messages;
  unsigned bus_errors;
  unsigned server_messages;
  unsigned no_responses;
  unsigned overruns;

  friend bool operator==(const Counts& a, const Counts& b) {
    return a.bus_messages == b.bus_messages && a.bus_errors == b.bus_errors &&
           a.server_messages == b.server_messages && a.no_responses == b.no_responses &&
           a.overruns == b.overruns;
  }
  friend std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << "0B " << c.bus_messages << ", 0C " << c.bus_errors << ", 0E " << c.server_messages
               << ", 0F " << c.no_responses << ", 12 " << c.overruns;
  }
};

class ReceiverTest : public testing::Test {
 protected:
  void listen(Protocol protocol, bool checksum = false) {
    receiver_.listen({protocol, checksum, LineTiming::at(kBaud, LineFormat::k8N1)});
    receiver_.answer_to(kOwn);
  }

  Duration byte(std::uint8_t value, ByteStatus status = ByteStatus::Good) {
    now_ = now_ + kCharacter;
    return receiver_.on_byte(value, status, ClockAt{now_});
  }
  void bytes(const FrameBytes& values) {
    for (const std::uint8_t value : values) {
      byte(value);
    }
  }
  void text(std::string_view characters) {
    for (const char character : characters) {
      byte(static_cast<std::uint8_t>(character));
    }
  }
  /// Lets a silence of 50 ms pass, which ends a Modbus frame. A silence does not end an ASCII frame.
  void silence() {
    now_ = now_ + milliseconds(50);
    while (!(receiver_.on_silence(now_) == Duration())) {
    }
  }
  void frame(const FrameBytes& values) {
    bytes(values);
    silence();
  }

  Counts counts() {
    LineTallies& tallies = receiver_.tallies();
    const Counts since_last{tallies.bus_messages(), tallies.bus_errors(), tallies.server_messages(),
                            tallies.no_responses(), tallies.overruns()};
    tallies.clear();
    return since_last;
  }
  Receiver receiver_;
  Time now_{1000};
};

TEST_F(ReceiverTest, AFrameWithFramingErrorsOrBreaksIsOneBusError) {
  listen(Protocol::ModbusRtu);
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break}) {
    byte(0x01);
    byte(0x05, status);
    byte(0x00, status);
    frame({0x00, 0xFF, 0x00, 0x8C, 0x3A});
    EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 0}));
  }
}

TEST_F(ReceiverTest, AFrameThatIsLostBecauseOfAnOverrunIsABusErrorAndAnOverrun) {
  listen(Protocol::ModbusRtu);
  byte(0x01);
  byte(0x05, ByteStatus::Overrun);
  byte(0x00, ByteStatus::Overrun);
  frame({0x00, 0xFF, 0x00, 0x8C, 0x3A});
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 1}));
  listen(Protocol::Ascii);
  text("$0");
  byte('1', ByteStatus::Overrun);
  text("M\r");
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 1}));
}

TEST_F(ReceiverTest, InBothProtocolsAFramingErrorOrABreakDamagesAByteButAnOverrunDoesNot) {
  for (const Protocol protocol : {Protocol::Ascii, Protocol::ModbusRtu}) {
    listen(protocol);
    receiver_.tallies().clear();
    byte('$', ByteStatus::FramingError);
    byte('$', ByteStatus::Break);
    byte('$', ByteStatus::Overrun);
    byte('$');
    silence();
    EXPECT_EQ(receiver_.tallies().damaged_bytes(), 2U);
    receiver_.tallies().clear();
    EXPECT_EQ(receiver_.tallies().damaged_bytes(), 0U);
  }
}

TEST_F(ReceiverTest, AFrameThatIsLostBecauseTheQueueIsFullIsCountedOnce) {
  listen(Protocol::Ascii);
  text("$01M\r$01F\r");
  EXPECT_EQ(receiver_.tallies().lost_frames(), 1U);
}

}  // namespace
}  // namespace ex9000
