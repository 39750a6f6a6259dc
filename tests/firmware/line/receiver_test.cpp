// Tests the receiver: host OKs, and requests that count like a host OK; protocol, checksum and address;
// required silences; the module's own replies (wire.md D9 and D11).
#include "firmware/line/receiver.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string_view>
#include <utility>

#include "firmware/model/baud.hpp"
#include "sim/app/play/modbus_frame.hpp"
#include "tests/firmware/line/receiver_bench.hpp"

namespace ex9000 {
namespace {

// --- host OK ---

TEST_F(ReceiverTest, AModbusHostOkIsReceivedAtTheEndOfItsSilence) {
  listen(Protocol::ModbusRtu);
  bytes(kHostOk);
  EXPECT_FALSE(host_oks());
  silence();
  expect_host_ok_at(now_);
}

TEST_F(ReceiverTest, AnAsciiHostOkIsReceivedAtItsCarriageReturn) {
  listen(Protocol::Ascii);
  text("~**\r");
  expect_host_ok_at(now_);
}

TEST_F(ReceiverTest, AsciiFramesOtherThanAHostOkAreNoHostOks) {
  listen(Protocol::Ascii);
  text("$01M\r$02M\r#**\r~**X\r");
  EXPECT_FALSE(host_oks());
}

// firmware/extensions.md, register 0x0251.
TEST_F(ReceiverTest, ARequestForThisModuleRestartsTheHostWatchdogIfThatIsSelected) {
  listen(Protocol::Ascii);
  text("$01M\r");
  EXPECT_FALSE(host_oks());
  receiver_.restart_by_requests(true);
  text("$01M\r");  // the first request still waits, so the queue is full
  expect_host_ok_at(now_);
  took_frame();
  text("$01Z\r");
  EXPECT_TRUE(host_oks());
  text("~**\r");
  EXPECT_TRUE(host_oks());
  text("$02M\r#**\r$**M\r$0\r!01\r$01M");  // the last frame is incomplete
  EXPECT_FALSE(host_oks());
  receiver_.restart_by_requests(false);
  text("\r");
  EXPECT_FALSE(host_oks());
}

TEST_F(ReceiverTest, AModbusRequestForThisModuleRestartsTheHostWatchdogAtTheEndOfItsSilence) {
  listen(Protocol::ModbusRtu);
  receiver_.restart_by_requests(true);
  bytes(with_crc({kOwn, 0x01, 0x00, 0x00, 0x00, 0x01}));
  EXPECT_FALSE(host_oks());
  silence();
  expect_host_ok_at(now_);
  frame(with_crc({kOwn, 0x77}));  // an unknown function, and the queue is full
  EXPECT_TRUE(host_oks());
  frame(with_crc({0x00, 0x05, 0x00, 0x00, 0xFF, 0x00}));
  frame(with_crc({0x02, 0x01, 0x00, 0x00, 0x00, 0x01}));
  frame(with_crc({kOwn, 0x81, 0x02}));  // an exception reply
  frame({kOwn, 0x01, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00});
  EXPECT_FALSE(host_oks());
}

TEST_F(ReceiverTest, AHostOkIsNotLostWhileAFrameWaits) {
  listen(Protocol::Ascii);
  text("$01M\r");
  text("~**\r");
  EXPECT_TRUE(host_oks());
  EXPECT_TRUE(took_frame());
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, AHostOkAcrossTheWrapOfTheClockKeepsItsTime) {
  now_ = Time(0U - 4 * kCharacter.microseconds());
  listen(Protocol::Ascii);
  text("~**\r");
  expect_host_ok_at(Time(0));
}

// --- protocol, checksum, address ---

TEST_F(ReceiverTest, AModuleWithModbusIgnoresAsciiCommands) {
  listen(Protocol::ModbusRtu);
  text("$01M\r");
  silence();
  EXPECT_FALSE(took_frame());
}

TEST_F(ReceiverTest, AModuleWithAsciiIgnoresModbusFrames) {
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

// --- required silences ---

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
  // The turn-around is one character time (wire.md section 3). In 8N2, the UART reports a byte one bit time
  // before the end of its last stop bit.
  const std::array<std::pair<LineFormat, unsigned>, 4> bits_of_turn_around{
      {{LineFormat::k8N1, 10}, {LineFormat::k8N2, 1 + 11}, {LineFormat::k8E1, 11}, {LineFormat::k8O1, 11}}};
  for (const auto& [format, bits] : bits_of_turn_around) {
    for (const std::uint32_t baud : kBaudRates) {
      Receiver receiver;
      receiver.listen({Protocol::Ascii, false, LineTiming::at(baud, format)});
      receiver.answer_to(kOwn);
      for (const char character : std::string_view("$01M")) {
        EXPECT_EQ(receiver.on_byte(static_cast<std::uint8_t>(character), ByteStatus::Good, ClockAt{now_})
                      .microseconds(),
                  0U);
      }
      const double turn_around = bits * 1e6 / baud;
      constexpr double kRounding = 3;
      const std::uint32_t required = receiver.on_byte('\r', ByteStatus::Good, ClockAt{now_}).microseconds();
      EXPECT_GE(required, turn_around) << baud;
      EXPECT_LE(required, turn_around + kRounding) << baud;
    }
  }
}

TEST_F(ReceiverTest, AsciiRequiresNoMoreSilenceAfterTheTurnAround) {
  listen(Protocol::Ascii);
  EXPECT_EQ(receiver_.on_silence(now_).microseconds(), 0U);
  text("$01");
  EXPECT_EQ(receiver_.on_silence(now_).microseconds(), 0U);
  text("M\r");
  EXPECT_EQ(receiver_.on_silence(now_).microseconds(), 0U);
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, AsciiRequiresNoSilenceAfterAHostOkOrIfTheQueueIsFull) {
  listen(Protocol::Ascii);
  for (const char character : std::string_view("~**\r")) {
    EXPECT_EQ(byte(static_cast<std::uint8_t>(character)).microseconds(), 0U);
  }
  EXPECT_TRUE(host_oks());
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
  EXPECT_EQ(receiver_.on_silence(now_).microseconds(), 0U);
  EXPECT_TRUE(took_frame());
}

TEST_F(ReceiverTest, ModbusWaitsForOneMoreCharacterAfterAWrongCrc) {
  listen(Protocol::ModbusRtu);
  bytes({0x01, 0x05, 0x00});
  // The wait is the time from the beginning of a byte to its report, rounded down. In 8N1, this is ten bits.
  constexpr double kTenBits = 10 * 1e6 / kBaud;
  constexpr double kRounding = 15;
  const std::uint32_t wanted = receiver_.on_silence(now_).microseconds();
  EXPECT_GE(wanted, kTenBits - kRounding);
  EXPECT_LT(wanted, kTenBits);
  EXPECT_EQ(receiver_.on_silence(now_).microseconds(), 0U);
}

TEST_F(ReceiverTest, SilenceWithoutAFrameRequiresNoMoreSilence) {
  listen(Protocol::ModbusRtu);
  EXPECT_EQ(receiver_.on_silence(now_).microseconds(), 0U);
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
  EXPECT_EQ(receiver_.on_silence(now_).microseconds(), 0U);
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

// wire.md D9 and D11: if the module begins a reply during the silence of a host OK, the module still judges
// the host OK. The host OK counts from the end of its silence, or from the end of the reply if that end is
// earlier.
TEST_F(ReceiverTest, AHostOkWhoseSilenceIsCutOffByAReplyCountsFromTheEndOfTheReply) {
  listen(Protocol::ModbusRtu);
  bytes(kHostOk);
  const Time spoken = now_ + Duration(100);
  receiver_.on_own_driver_off(spoken);
  expect_host_ok_at(spoken);
}

TEST_F(ReceiverTest, AHostOkWhoseSilenceEndsDuringAReplyCountsFromTheEndOfItsSilence) {
  listen(Protocol::ModbusRtu);
  bytes(kHostOk);
  const Time over = now_ + receiver_.timing().rtu_silence;
  receiver_.on_silence(over);
  receiver_.on_own_driver_off(now_ + milliseconds(50));
  expect_host_ok_at(over);
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
