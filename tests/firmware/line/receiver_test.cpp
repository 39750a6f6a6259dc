// Tests the receiver: protocol selection, the counters of function 08 (wire.md D1), host OK, D9.
#include "firmware/line/receiver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/model/baud.hpp"
#include "sim/play/modbus_frame.hpp"

namespace ex9000 {
namespace {

using FrameBytes = std::vector<std::uint8_t>;

constexpr std::uint8_t kOwn = 0x01;
constexpr std::uint32_t kBaud = 9600;
constexpr Duration kCharacter = Duration(1042);

const FrameBytes kChannel0On{0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3A};
const FrameBytes kHostOk{0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x07};
const FrameBytes kGuideExample{0x02, 0x07, 0x41, 0x12};  // addressed to module 02

/// The receiver's counters, in the order of sub-functions 0B, 0C, 0E, 0F, 12.
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
    return receiver_.on_byte(value, status, now_);
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
  /// Passes a silence that is long enough to end every frame.
  void silence() {
    now_ = now_ + milliseconds(50);
    while (!(receiver_.on_silence() == Duration())) {
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
  void expect_host_ok_between(Time earliest, Time latest) {
    EXPECT_LE(receiver_.host_oks().last().since(earliest).microseconds(),
              latest.since(earliest).microseconds());
  }
  bool took_frame() {
    if (!receiver_.queue().has_frame()) {
      return false;
    }
    receiver_.queue().drop_in_main_loop();
    return true;
  }

  /// Returns how often the host watchdog has been restarted since the last call.
  std::uint32_t restarts() {
    const std::uint32_t before = restarts_;
    restarts_ = receiver_.host_oks().received();
    return restarts_ - before;
  }

  Receiver receiver_;
  Time now_{1000};

 private:
  std::uint32_t restarts_ = 0;
};

// --- counters ---

TEST_F(ReceiverTest, CountsNothingBeforeAnythingIsReceived) {
  listen(Protocol::ModbusRtu);
  EXPECT_EQ(counts(), (Counts{0, 0, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameForThisModuleIsABusAndAServerMessage) {
  listen(Protocol::ModbusRtu);
  frame(kChannel0On);
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 0, 0}));
}

TEST_F(ReceiverTest, AFrameForAnotherModuleIsABusMessage) {
  listen(Protocol::ModbusRtu);
  frame(kGuideExample);
  EXPECT_EQ(counts(), (Counts{1, 0, 0, 0, 0}));
}

TEST_F(ReceiverTest, AHostOkIsAServerMessageWithoutAReply) {
  listen(Protocol::ModbusRtu);
  frame(kHostOk);
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 1, 0}));
}

TEST_F(ReceiverTest, AWrongCrcIsABusError) {
  listen(Protocol::ModbusRtu);
  frame({0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3B});
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameOfLessThan4BytesIsABusError) {
  listen(Protocol::ModbusRtu);
  frame({0x01});
  frame({0x01, 0x05, 0x00});
  EXPECT_EQ(counts(), (Counts{0, 2, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameOfMoreThan256BytesIsOneBusError) {
  listen(Protocol::ModbusRtu);
  frame(FrameBytes(257, 0x55));
  frame(FrameBytes(600, 0x55));
  EXPECT_EQ(counts(), (Counts{0, 2, 0, 0, 0}));
}

TEST_F(ReceiverTest, AFrameSpoiledByALineErrorIsOneBusError) {
  listen(Protocol::ModbusRtu);
  for (const ByteStatus status : {ByteStatus::FramingError, ByteStatus::Break}) {
    byte(0x01);
    byte(0x05, status);
    byte(0x00, status);
    frame({0x00, 0xFF, 0x00, 0x8C, 0x3A});
    EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 0}));
  }
}

TEST_F(ReceiverTest, AFrameLostToAnOverrunIsABusErrorAndAnOverrun) {
  listen(Protocol::ModbusRtu);
  byte(0x01);
  byte(0x05, ByteStatus::Overrun);
  byte(0x00, ByteStatus::Overrun);
  frame({0x00, 0xFF, 0x00, 0x8C, 0x3A});
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 1}));
}

TEST_F(ReceiverTest, AFrameReceivedWhileTheQueueIsFullCountsAsAnOverrun) {
  listen(Protocol::ModbusRtu);
  frame(kChannel0On);
  counts();
  frame(kChannel0On);
  const Counts counted = counts();
  EXPECT_EQ(counted.bus_messages, 1U);
  EXPECT_EQ(counted.bus_errors, 0U);
  EXPECT_EQ(counted.overruns, 1U);
}

TEST_F(ReceiverTest, CountsEveryFrameOnce) {
  listen(Protocol::ModbusRtu);
  for (int i = 0; i < 300; ++i) {
    frame(kChannel0On);
    EXPECT_TRUE(took_frame());
    frame(kGuideExample);
    frame({0xFF});
  }
  EXPECT_EQ(counts(), (Counts{600, 300, 300, 0, 0}));
}

TEST_F(ReceiverTest, AnOpenFrameIsNotCounted) {
  listen(Protocol::ModbusRtu);
  bytes(kChannel0On);
  EXPECT_EQ(counts(), (Counts{0, 0, 0, 0, 0}));
}

TEST_F(ReceiverTest, EveryDamagedByteIsCountedInBothProtocols) {
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

TEST_F(ReceiverTest, AFrameForWhichThereIsNoRoomIsCountedOnce) {
  listen(Protocol::Ascii);
  text("$01M\r$01F\r");
  EXPECT_EQ(receiver_.tallies().lost_frames(), 1U);
}

TEST_F(ReceiverTest, InAsciiEachCompleteFrameIsABusMessageOrABusError) {
  listen(Protocol::Ascii, true);
  text("$01MD2\r");  // right
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 0, 0}));
  text("$02MD3\r");  // for another module
  EXPECT_EQ(counts(), (Counts{1, 0, 0, 0, 0}));
  text("~**D2\r#**77\r$**78\r");  // host OK, a sample for which there is no room, no command
  EXPECT_EQ(counts(), (Counts{3, 0, 2, 2, 1}));
  text("$01MD3\r$0\r$01M78901234567890123456789012345\r");  // wrong, missing, too long
  EXPECT_EQ(counts(), (Counts{0, 3, 0, 0, 0}));
  byte('$');
  byte('0', ByteStatus::Overrun);
  text("1M\r");
  EXPECT_EQ(counts(), (Counts{0, 1, 0, 0, 1}));
}

// --- host OK ---

TEST_F(ReceiverTest, AModbusHostOkIsReceivedAtTheEndOfItsSilence) {
  listen(Protocol::ModbusRtu);
  const std::uint32_t before = receiver_.host_oks().received();
  bytes(kHostOk);
  const Time end = now_;
  EXPECT_EQ(receiver_.host_oks().received(), before);
  silence();
  EXPECT_EQ(receiver_.host_oks().received(), before + 1);
  expect_host_ok_between(end, now_);
}

TEST_F(ReceiverTest, AnAsciiHostOkIsReceivedAtItsCarriageReturn) {
  listen(Protocol::Ascii);
  text("~**\r");
  EXPECT_EQ(receiver_.host_oks().received(), 1);
  EXPECT_EQ(receiver_.host_oks().last().microseconds(), now_.microseconds());
}

TEST_F(ReceiverTest, EveryHostOkIsCounted) {
  listen(Protocol::Ascii);
  for (std::uint8_t i = 1; i <= 200; ++i) {
    text("~**\r");
    EXPECT_EQ(receiver_.host_oks().received(), i);
  }
}

TEST_F(ReceiverTest, NoOtherFrameIsAHostOk) {
  listen(Protocol::Ascii);
  text("$01M\r$02M\r#**\r~**X\r");
  EXPECT_EQ(receiver_.host_oks().received(), 0);
}

// firmware/extensions.md, register 0x0251.
TEST_F(ReceiverTest, ARequestForThisModuleRestartsTheHostWatchdogIfThatIsSelected) {
  listen(Protocol::Ascii);
  text("$01M\r");
  EXPECT_EQ(restarts(), 0U);
  receiver_.restart_by_requests(true);
  text("$01M\r");  // the first one still waits, so there is no room
  EXPECT_EQ(restarts(), 1U);
  EXPECT_EQ(receiver_.host_oks().last().microseconds(), now_.microseconds());
  took_frame();
  text("$01Z\r");
  EXPECT_EQ(restarts(), 1U);
  text("~**\r");
  EXPECT_EQ(restarts(), 1U);
  text("$02M\r#**\r$**M\r$0\r!01\r$01M");  // incomplete at the end
  EXPECT_EQ(restarts(), 0U);
  receiver_.restart_by_requests(false);
  text("\r");
  EXPECT_EQ(restarts(), 0U);
}

TEST_F(ReceiverTest, AModbusRequestForThisModuleRestartsTheHostWatchdogAtTheEndOfItsSilence) {
  listen(Protocol::ModbusRtu);
  receiver_.restart_by_requests(true);
  bytes(with_crc({kOwn, 0x01, 0x00, 0x00, 0x00, 0x01}));
  EXPECT_EQ(restarts(), 0U);
  const Time end = now_;
  silence();
  EXPECT_EQ(restarts(), 1U);
  expect_host_ok_between(end, now_);
  frame(with_crc({kOwn, 0x77}));  // an unknown function, and no room
  EXPECT_EQ(restarts(), 1U);
  frame(with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00}));
  frame(with_crc({0x02, 0x01, 0x00, 0x00, 0x00, 0x01}));
  frame({kOwn, 0x01, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00});
  EXPECT_EQ(restarts(), 0U);
}

TEST_F(ReceiverTest, AHostOkIsNotLostWhileAFrameWaits) {
  listen(Protocol::Ascii);
  text("$01M\r");
  text("~**\r");
  EXPECT_EQ(receiver_.host_oks().received(), 1);
  EXPECT_TRUE(took_frame());
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, AHostOkAcrossTheWrapOfTheClockKeepsItsTime) {
  now_ = Time(0U - 4 * kCharacter.microseconds());
  listen(Protocol::Ascii);
  text("~**\r");
  EXPECT_EQ(receiver_.host_oks().last().microseconds(), 0U);
}

// --- protocol, checksum, address ---

TEST_F(ReceiverTest, ModbusIgnoresAscii) {
  listen(Protocol::ModbusRtu);
  text("$01M\r");
  silence();
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, AsciiIgnoresModbus) {
  listen(Protocol::Ascii);
  frame(kChannel0On);
  byte('\r');
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, TheChecksumIsRequiredIfItIsEnabled) {
  listen(Protocol::Ascii, true);
  text("$012\r");
  EXPECT_FALSE(took_frame());
  text("$012B7\r");
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, ANewAddressAppliesToTheNextFrameThatEnds) {
  listen(Protocol::Ascii);
  text("$02M");
  receiver_.answer_to(0x02);
  text("\r");
  EXPECT_TRUE(took_frame());
  text("$01M\r");
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, ANewAddressAppliesToModbusToo) {
  listen(Protocol::ModbusRtu);
  frame(kGuideExample);
  EXPECT_FALSE(took_frame());
  receiver_.answer_to(0x02);
  frame(kGuideExample);
  EXPECT_TRUE(took_frame());
}

// --- durations ---

TEST_F(ReceiverTest, AsciiRequiresNoSilenceWithinAFrameOrAfterARejectedFrame) {
  listen(Protocol::Ascii, true);
  for (const std::string_view text : {"$01M", "\r", "$02MD3\r", "$012B8\r", "noise\r", "~**\r", "~**D2"}) {
    for (const char character : text) {
      EXPECT_EQ(byte(static_cast<std::uint8_t>(character)).microseconds(), 0U) << text;
    }
  }
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, AsciiRequiresTheFullTurnAroundAfterAnAcceptedFrame) {
  // The turn-around is one character (wire.md section 3). A byte of 8N2 is reported a bit before its end.
  const std::array<std::pair<LineFormat, unsigned>, 4> bits_of_turn_around{
      {{LineFormat::k8N1, 10}, {LineFormat::k8N2, 1 + 11}, {LineFormat::k8E1, 11}, {LineFormat::k8O1, 11}}};
  for (const auto& [format, bits] : bits_of_turn_around) {
    for (const std::uint32_t baud : kBaudRates) {
      Receiver receiver;
      receiver.listen({Protocol::Ascii, false, LineTiming::at(baud, format)});
      receiver.answer_to(kOwn);
      for (const char character : std::string_view("$01M")) {
        EXPECT_EQ(
            receiver.on_byte(static_cast<std::uint8_t>(character), ByteStatus::Good, now_).microseconds(),
            0U);
      }
      const double turn_around = bits * 1e6 / baud;
      constexpr double kRounding = 3;
      const std::uint32_t required = receiver.on_byte('\r', ByteStatus::Good, now_).microseconds();
      EXPECT_GE(required, turn_around) << baud;
      EXPECT_LE(required, turn_around + kRounding) << baud;
    }
  }
}

TEST_F(ReceiverTest, AsciiRequiresNoMoreSilenceAfterTheTurnAround) {
  listen(Protocol::Ascii);
  EXPECT_EQ(receiver_.on_silence().microseconds(), 0U);
  text("$01");
  EXPECT_EQ(receiver_.on_silence().microseconds(), 0U);
  text("M\r");
  EXPECT_EQ(receiver_.on_silence().microseconds(), 0U);
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, AsciiRequiresNoSilenceAfterAHostOkOrIfTheQueueIsFull) {
  listen(Protocol::Ascii);
  for (const char character : std::string_view("~**\r")) {
    EXPECT_EQ(byte(static_cast<std::uint8_t>(character)).microseconds(), 0U);
  }
  EXPECT_EQ(receiver_.host_oks().received(), 1U);
  text("$01M\r");
  for (const char character : std::string_view("$012\r")) {
    EXPECT_EQ(byte(static_cast<std::uint8_t>(character)).microseconds(), 0U);
  }
  EXPECT_TRUE(took_frame());
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, ModbusRequiresAtLeastT35AfterEveryByte) {
  listen(Protocol::ModbusRtu);
  constexpr double kT35 = 3.5 * 11 * 1e6 / kBaud;
  constexpr double kRounding = 3;
  for (const std::uint8_t value : kChannel0On) {
    const std::uint32_t wanted = byte(value).microseconds();
    EXPECT_GE(wanted, kT35);
    EXPECT_LE(wanted, kT35 + kRounding);
  }
}

TEST_F(ReceiverTest, ModbusRequiresNoMoreSilenceAfterACorrectCrc) {
  listen(Protocol::ModbusRtu);
  bytes(kChannel0On);
  EXPECT_EQ(receiver_.on_silence().microseconds(), 0U);
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, ModbusWaitsOneMoreCharacterAfterAWrongCrc) {
  listen(Protocol::ModbusRtu);
  bytes({0x01, 0x05, 0x00});
  // The wait lasts from T3.5, which the timer rounds up, to the end of a byte that began at T3.5.
  constexpr double kTenBits = 10 * 1e6 / kBaud;
  constexpr double kRounding = 5;
  const std::uint32_t wanted = receiver_.on_silence().microseconds();
  EXPECT_GE(wanted, kTenBits - kRounding);
  EXPECT_LT(wanted, kTenBits);
  EXPECT_EQ(receiver_.on_silence().microseconds(), 0U);
}

TEST_F(ReceiverTest, SilenceWithoutAFrameRequiresNoMoreSilence) {
  listen(Protocol::ModbusRtu);
  EXPECT_EQ(receiver_.on_silence().microseconds(), 0U);
  EXPECT_EQ(counts(), (Counts{0, 0, 0, 0, 0}));
}

// --- replies of the module ---

TEST_F(ReceiverTest, AnOpenAsciiFrameIsDiscardedWhenTheModuleTransmits) {
  listen(Protocol::Ascii);
  text("$01");
  receiver_.on_own_driver_off(now_);
  text("M\r");
  EXPECT_FALSE(took_frame());
  text("$01M\r");
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, AnOpenModbusFrameIsDiscardedWhenTheModuleTransmits) {
  listen(Protocol::ModbusRtu);
  bytes({0x01, 0x05, 0x00});
  receiver_.on_own_driver_off(now_);
  EXPECT_EQ(receiver_.on_silence().microseconds(), 0U);
  EXPECT_EQ(counts(), (Counts{0, 0, 0, 0, 0}));
  frame(kChannel0On);
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, ACompleteModbusFrameIsAcceptedWhenTheModuleTransmits) {
  listen(Protocol::ModbusRtu);
  bytes(kChannel0On);
  receiver_.on_own_driver_off(now_);
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 0, 0}));
  EXPECT_TRUE(took_frame());
}

// wire.md D9: the host OK is judged after the module's reply. The reply may end before the silence that
// belongs to the host OK would have ended.
TEST_F(ReceiverTest, AHostOkWhoseSilenceIsCutOffByAReplyCountsFromTheEndOfTheReply) {
  listen(Protocol::ModbusRtu);
  bytes(kHostOk);
  const Time spoken = now_ + Duration(100);
  receiver_.on_own_driver_off(spoken);
  EXPECT_EQ(receiver_.host_oks().received(), 1U);
  EXPECT_EQ(receiver_.host_oks().last().microseconds(), spoken.microseconds());
}

TEST_F(ReceiverTest, AHostOkWhoseSilenceEndsDuringAReplyCountsFromTheEndOfItsSilence) {
  listen(Protocol::ModbusRtu);
  bytes(kHostOk);
  const Time over = now_ + receiver_.timing().rtu_silence;
  receiver_.on_own_driver_off(now_ + milliseconds(50));
  EXPECT_EQ(receiver_.host_oks().received(), 1U);
  EXPECT_EQ(receiver_.host_oks().last().microseconds(), over.microseconds());
}

TEST_F(ReceiverTest, TheNextFrameDoesNotContinueADiscardedOne) {
  listen(Protocol::ModbusRtu);
  bytes({0x01, 0x05, 0x00});
  receiver_.on_own_driver_off(now_);
  frame(kChannel0On);
  EXPECT_TRUE(took_frame());
  EXPECT_EQ(counts(), (Counts{1, 0, 1, 0, 0}));
}

TEST_F(ReceiverTest, TransmittingKeepsTheWaitingFrame) {
  listen(Protocol::Ascii);
  text("$01M\r");
  receiver_.on_own_driver_off(now_);
  text("$02M\r");
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, TransmittingDoesNotDiscardTheNextFrame) {
  listen(Protocol::Ascii);
  for (int i = 0; i < 300; ++i) {
    receiver_.on_own_driver_off(now_);
    text("$01M\r");
    EXPECT_TRUE(took_frame()) << i;
  }
}

}  // namespace
}  // namespace ex9000
