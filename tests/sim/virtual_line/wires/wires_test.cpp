// Tests the virtual line.
#include "sim/virtual_line/wires/wires.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "sim/virtual_line/line/line.hpp"
#include "sim/virtual_line/wires/master.hpp"
#include "tests/sim/virtual_line/wires/wires_recorder.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

struct Heard {
  std::uint8_t byte;
  ByteStatus status;
  VirtualTime at;
};

/// A station that records the bytes that it receives.
class Listener final : public Station {
 public:
  Listener(Wires& wires, std::uint32_t baud, LineFormat format = LineFormat::k8N1)
      : clock_(wires.clock()), wire_(wires.attach(*this)) {
    wire_.listen({baud, format});
  }

  void run() override {}
  void receive(std::uint8_t byte, ByteStatus status) override {
    heard.push_back({byte, status, clock_.virtual_now()});
  }

  void set_baud(std::uint32_t baud) { wire_.listen({baud}); }
  [[nodiscard]] std::string text() const {
    std::string all;
    for (const Heard& each : heard) {
      all += static_cast<char>(each.byte);
    }
    return all;
  }

  std::vector<Heard> heard;

 private:
  VirtualClock& clock_;
  WireEnd& wire_;
};

/// A station that does not listen. The test controls this station's end of the wires.
class Sender final : public Station {
 public:
  void run() override {}
};

class BusTest : public testing::Test {
 protected:
  std::unique_ptr<Master> master(std::uint32_t baud, LineFormat format = LineFormat::k8N1) {
    return std::make_unique<Master>(wires_, SerialMode{baud, format},
                                    [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  }
  static void send(Master& master, std::vector<std::uint8_t> bytes) {
    master.send(bytes.data(), bytes.size());
  }

  VirtualClock clock_;
  Wires wires_{clock_};
};

TEST_F(BusTest, AByteIn8N1TakesTenBitsAtItsSendersRate) {
  for (const std::uint32_t baud : kBaudRates) {
    VirtualClock clock;
    Wires wires(clock);
    Master sender(wires, SerialMode{baud}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
    Listener listener(wires, baud);
    const std::vector<std::uint8_t> bytes(100, 0x55);
    sender.send(bytes.data(), bytes.size());
    wires.run_for(std::chrono::seconds(2));
    ASSERT_EQ(listener.heard.size(), 100U) << baud;
    EXPECT_EQ(listener.heard.front().at, nanoseconds(10'000'000'000 / baud)) << baud;
    EXPECT_NEAR(static_cast<double>(listener.heard.back().at.count()), 1000e9 / baud, 2.0) << baud;
  }
}

TEST_F(BusTest, AMasterDropsTheWaitingBytesOfOneSender) {
  Master master(wires_, SerialMode{9600}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  Listener listener(wires_, 9600);
  const int first = 0;
  const int second = 0;
  const std::vector<std::uint8_t> bytes{'a', 'b', 'c'};
  master.send(bytes.data(), bytes.size(), {}, {}, &first);
  master.send(bytes.data(), bytes.size(), {}, {}, &second);
  master.send(bytes.data(), bytes.size());
  wires_.run_for(VirtualTime(0));  // the start bit of the first byte has been sent
  master.drop(&first);
  wires_.run_for(std::chrono::seconds(1));
  EXPECT_EQ(listener.text(), "aabcabc");
  EXPECT_FALSE(master.sending());
  master.send(bytes.data(), bytes.size(), {}, {}, &first);
  wires_.run_for(VirtualTime(0));
  master.drop(&first);
  wires_.run_for(std::chrono::seconds(1));
  EXPECT_EQ(listener.text(), "aabcabca");
  EXPECT_FALSE(wires_.busy());
}

TEST_F(BusTest, StopsInTheMiddleOfABurst) {
  Master master(wires_, SerialMode{9600}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  Listener listener(wires_, 9600);
  const std::vector<std::uint8_t> bytes{'a', 'b', 'c'};
  master.send(bytes.data(), bytes.size());
  wires_.run_until(microseconds(1500));  // a byte takes 1042 us
  EXPECT_EQ(wires_.clock().virtual_now(), microseconds(1500));
  EXPECT_EQ(listener.text(), "a");
  EXPECT_TRUE(wires_.carries());
  master.drop(nullptr);
  wires_.run_until(milliseconds(10));
  EXPECT_EQ(listener.text(), "ab");
}

TEST_F(BusTest, IsBusyWhileADriverIsEnabledEvenWithoutAByte) {
  Sender sender;
  WireEnd& end = wires_.attach(sender);
  EXPECT_FALSE(wires_.busy());
  end.drive(true);
  EXPECT_TRUE(wires_.busy());
  EXPECT_FALSE(wires_.carries());
  end.drive(false);
  EXPECT_FALSE(wires_.busy());
}

TEST_F(BusTest, AByteThatWasCutOffStaysCutOffWhenItsStationCutsOffAnotherByte) {
  Sender sender;
  WireEnd& end = wires_.attach(sender);
  Listener listener(wires_, 9600);
  end.drive(true);
  end.put({0x00, {1200}});  // would last 8.3 ms
  wires_.run_for(microseconds(200));
  end.drive(false);
  wires_.run_for(milliseconds(4));
  end.drive(true);
  end.put({0xFF, {9600}});
  wires_.run_for(microseconds(370));  // just after the middle of data bit 2
  end.drive(false);
  wires_.run_for(milliseconds(10));
  ASSERT_EQ(listener.heard.size(), 2U);
  EXPECT_EQ(listener.heard[0].byte, 0xFE);  // for 0.2 ms, the level is 0: start bit, data bit 0
  EXPECT_EQ(listener.heard[1].byte, 0xFF);
}

constexpr std::array<LineFormat, 4> kFormats{LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1,
                                             LineFormat::k8O1};

TEST_F(BusTest, AByteTakesElevenBitsInTheFormatsOtherThan8N1) {
  for (const std::uint32_t baud : kBaudRates) {
    for (const LineFormat format : {LineFormat::k8N2, LineFormat::k8E1, LineFormat::k8O1}) {
      VirtualClock clock;
      Wires wires(clock);
      Master sender(wires, {baud, format}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
      EXPECT_EQ(sender.takes(1), nanoseconds(11'000'000'000 / baud));
      Listener listener(wires, baud, format);
      const std::vector<std::uint8_t> bytes(100, 0x55);
      sender.send(bytes.data(), bytes.size());
      wires.run_for(std::chrono::seconds(2));
      ASSERT_EQ(listener.heard.size(), 100U) << baud;
      // Receivers ignore a second stop bit, so they get a byte at the end of its first stop bit.
      const double first = format == LineFormat::k8N2 ? 10e9 / baud : 11e9 / baud;
      EXPECT_NEAR(static_cast<double>(listener.heard.front().at.count()), first, 1.0) << baud;
      EXPECT_NEAR(static_cast<double>(listener.heard.back().at.count()), 99 * 11e9 / baud + first, 2.0)
          << baud;
    }
  }
}

TEST_F(BusTest, OnlyReceiversWithTheSendersParityReceiveAllBytesWithoutError) {
  for (const LineFormat sent : kFormats) {
    for (const LineFormat heard : kFormats) {
      VirtualClock clock;
      Wires wires(clock);
      Master sender(wires, {9600, sent}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
      Listener listener(wires, 9600, heard);
      bool all_good = true;
      for (const std::uint8_t byte : std::vector<std::uint8_t>{0x00, 0x01, 0x03, 0x80, 0xAA, 0xFE, 0xFF}) {
        sender.send(&byte, 1);
        wires.run_for(milliseconds(3));
        ASSERT_FALSE(listener.heard.empty());
        all_good = all_good && listener.heard[0].status == ByteStatus::Good && listener.heard[0].byte == byte;
        listener.heard.clear();
      }
      const bool same_parity = sent == heard || (!has_parity(sent) && !has_parity(heard));
      EXPECT_EQ(all_good, same_parity) << static_cast<int>(sent) << " to " << static_cast<int>(heard);
    }
  }
}

TEST_F(BusTest, AReceiverWithTheOtherParityReportsTheByteWithAParityError) {
  const auto sender = master(9600, LineFormat::k8E1);
  Listener odd(wires_, 9600, LineFormat::k8O1);
  send(*sender, {0x00, 0x31, 0xFF});
  wires_.run_for(milliseconds(10));
  ASSERT_EQ(odd.heard.size(), 3U);
  EXPECT_EQ(odd.heard[1].byte, 0x31);
  for (const Heard& heard : odd.heard) {
    EXPECT_EQ(heard.status, ByteStatus::ParityError);
  }
}

TEST_F(BusTest, DamagedBytesOfTheMasterArriveWithParityErrorsAndTheOthersAreGood) {
  for (const LineFormat format : {LineFormat::k8E1, LineFormat::k8O1}) {
    VirtualClock clock;
    Wires wires(clock);
    Master sender(wires, {9600, format}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
    Listener listener(wires, 9600, format);
    const std::vector<std::uint8_t> bytes{0x24, 0x30, 0x31, 0x4D, 0x0D};
    sender.send(bytes.data(), bytes.size(), VirtualTime(0), {1, 4});
    wires.run_for(milliseconds(10));
    ASSERT_EQ(listener.heard.size(), 5U);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      EXPECT_EQ(listener.heard[i].byte, bytes[i]);
      EXPECT_EQ(listener.heard[i].status, i == 1 || i == 4 ? ByteStatus::ParityError : ByteStatus::Good) << i;
    }
  }
}

// The parity bit of 0x30 is 0, so the receiver reports a framing error. The parity bit of 0x31 is 1, like a
// stop bit.
TEST_F(BusTest, AReceiverWithoutParityReadsTheParityBitAsTheStopBit) {
  const auto sender = master(9600, LineFormat::k8E1);
  Listener plain(wires_, 9600);
  send(*sender, {0x30, 0x31});
  wires_.run_for(milliseconds(10));
  ASSERT_EQ(plain.heard.size(), 2U);
  EXPECT_EQ(plain.heard[0].status, ByteStatus::FramingError);
  EXPECT_EQ(plain.heard[1].status, ByteStatus::Good);
  EXPECT_EQ(plain.heard[1].byte, 0x31);
}

TEST_F(BusTest, EveryStationAtTheSameRateReceivesEveryByteIntact) {
  const auto sender = master(9600);
  std::vector<std::unique_ptr<Listener>> listeners;
  for (int i = 0; i < 33; ++i) {
    listeners.push_back(std::make_unique<Listener>(wires_, 9600));
  }
  send(*sender, {0x00, 0xFF, 0x24});
  wires_.run_for(milliseconds(10));
  for (const auto& listener : listeners) {
    ASSERT_EQ(listener->heard.size(), 3U);
    EXPECT_EQ(listener->heard[0].byte, 0x00);
    EXPECT_EQ(listener->heard[1].byte, 0xFF);
    EXPECT_EQ(listener->heard[2].byte, 0x24);
    EXPECT_EQ(listener->heard[2].status, ByteStatus::Good);
  }
}

TEST_F(BusTest, AReceiverAtHalfTheRateReceivesFewerAndWrongBytes) {
  const auto sender = master(19200);
  Listener slow(wires_, 9600);
  // '0' is 0 00001100 1 on the wire; two of these bits fall into one bit of the receiver.
  send(*sender, std::vector<std::uint8_t>(20, 0x30));
  wires_.run_for(milliseconds(30));
  ASSERT_FALSE(slow.heard.empty());
  EXPECT_LT(slow.heard.size(), 20U);
  for (const Heard& heard : slow.heard) {
    EXPECT_NE(heard.byte, 0x30);
  }
}

TEST_F(BusTest, AMuchFasterReceiverReportsAZeroByteAsABreak) {
  const auto sender = master(1200);
  Listener fast(wires_, 115200);
  send(*sender, {0x00});
  wires_.run_for(milliseconds(30));
  ASSERT_EQ(fast.heard.size(), 1U);
  EXPECT_EQ(fast.heard[0].byte, 0x00);
  EXPECT_EQ(fast.heard[0].status, ByteStatus::Break);
}

TEST_F(BusTest, AReceiverRecoversAfterTrafficAtAnotherRate) {
  const auto sender = master(1200);
  Listener listener(wires_, 9600);
  send(*sender, {0x31, 0x32, 0x33});
  wires_.run_for(milliseconds(50));
  listener.heard.clear();
  sender->set_baud(9600);
  send(*sender, {0x31, 0x32});
  wires_.run_for(milliseconds(50));
  ASSERT_EQ(listener.heard.size(), 2U);
  EXPECT_EQ(listener.heard[0].byte, 0x31);
  EXPECT_EQ(listener.heard[1].byte, 0x32);
}

TEST_F(BusTest, IfTwoDriversSendSimultaneouslyAZeroBitOverridesAOne) {
  const auto first = master(9600);
  const auto second = master(9600);
  Listener listener(wires_, 9600);
  send(*first, {0xF3});
  send(*second, {0x3F});
  wires_.run_for(milliseconds(10));
  ASSERT_EQ(listener.heard.size(), 1U);
  EXPECT_EQ(listener.heard[0].byte, 0x33);
}

TEST_F(BusTest, OverlappingBytesAreReportedAsACollisionAndArriveCorrupted) {
  const auto first = master(9600);
  const auto second = master(9600);
  Listener listener(wires_, 9600);
  WiresRecorder recorder;
  wires_.observe(recorder);
  send(*first, {0x55, 0x55});
  wires_.run_for(microseconds(700));
  send(*second, {0x55});
  wires_.run_for(milliseconds(10));
  ASSERT_EQ(recorder.bytes.size(), 3U);
  for (const WiresRecorder::Byte& byte : recorder.bytes) {
    EXPECT_TRUE(byte.collided);
  }
  bool spoiled = false;
  for (const Heard& heard : listener.heard) {
    spoiled = spoiled || heard.byte != 0x55 || heard.status != ByteStatus::Good;
  }
  EXPECT_TRUE(spoiled);
}

TEST_F(BusTest, IfADriverIsDisabledDuringAByteTheLineBecomesIdle) {
  const auto sender = master(9600);
  Listener listener(wires_, 9600);
  SimulatedModule module(wires_, *find_model("EX9042D-M"));
  module.power(true);
  wires_.run_for(milliseconds(100));
  send(*sender, {0x01, 0x01, 0x00, 0x00, 0x00, 0x0D, 0xFD, 0xCF});
  WiresRecorder recorder;
  wires_.observe(recorder);
  while (recorder.bytes.size() < 9) {  // eight bytes from the master, one from the module
    wires_.run_until(wires_.next());
  }
  wires_.run_for(microseconds(300));
  module.power(false);
  wires_.run_for(milliseconds(10));
  EXPECT_FALSE(wires_.busy());
  EXPECT_EQ(recorder.bytes.size(), 9U);
  EXPECT_FALSE(recorder.drivers.back().on);
}

TEST_F(BusTest, ACommandSentToAnUnpoweredModuleIsNotExecutedLater) {
  const auto sender = master(9600);
  SimulatedModule module(wires_, *find_model("EX9043D"));
  module.power(true);
  wires_.run_for(milliseconds(100));
  send(*sender, {0x00});
  wires_.run_for(microseconds(300));
  module.power(false);
  EXPECT_EQ(module.mode().baud, 0U);
  wires_.run_for(milliseconds(10));
  send(*sender, {'@', '0', '1', 'F', 'F', 'F', 'F', '\r'});
  wires_.run_for(milliseconds(100));
  module.power(true);
  wires_.run_for(milliseconds(100));
  WiresRecorder recorder;
  wires_.observe(recorder);
  send(*sender, {'$', '0', '1', 'M', '\r'});
  wires_.run_for(milliseconds(100));
  EXPECT_EQ(module.outputs(), 0);
  EXPECT_EQ(recorder.sent_by(1), (std::vector<std::uint8_t>{'!', '0', '1', '9', '0', '4', '3', 'D', '\r'}));
}

TEST_F(BusTest, AReceiverThatIsEnabledDuringAByteDoesNotReceiveThisByte) {
  const auto sender = master(9600);
  Listener listener(wires_, 0);
  send(*sender, {0x55});
  wires_.run_for(microseconds(500));
  listener.set_baud(9600);
  wires_.run_for(milliseconds(5));
  for (const Heard& heard : listener.heard) {
    EXPECT_NE(heard.byte, 0x55);
  }
}

}  // namespace
}  // namespace ex9000::sim
