// Tests the wires of a line. reception_test.cpp tests what receivers get in each kind of trouble.
#include "sim/virtual_line/wires/wires.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "sim/virtual_line/wires/master.hpp"
#include "tests/sim/virtual_line/wires/wires_recorder.hpp"

namespace ex9000::sim {
namespace {

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

TEST(Wires, AMasterDropsTheWaitingBytesOfOneSender) {
  VirtualClock clock;
  Wires wires(clock);
  Master master(wires, SerialMode{9600}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  Listener listener(wires, 9600);
  const int first = 0;
  const int second = 0;
  const std::vector<std::uint8_t> bytes{'a', 'b', 'c'};
  master.send(bytes.data(), bytes.size(), {}, {}, &first);
  master.send(bytes.data(), bytes.size(), {}, {}, &second);
  master.send(bytes.data(), bytes.size());
  wires.run_for(VirtualTime(0));  // the start bit of the first byte has been sent
  master.drop(&first);
  wires.run_for(std::chrono::seconds(1));
  EXPECT_EQ(listener.text(), "aabcabc");
  EXPECT_FALSE(master.sending());
  master.send(bytes.data(), bytes.size(), {}, {}, &first);
  wires.run_for(VirtualTime(0));
  master.drop(&first);
  wires.run_for(std::chrono::seconds(1));
  EXPECT_EQ(listener.text(), "aabcabca");
  EXPECT_FALSE(wires.busy());
}

TEST(Wires, IsBusyWhileADriverIsEnabledEvenWithoutAByte) {
  VirtualClock clock;
  Wires wires(clock);
  Sender sender;
  WireEnd& end = wires.attach(sender);
  EXPECT_FALSE(wires.busy());
  end.drive(true);
  EXPECT_TRUE(wires.busy());
  EXPECT_FALSE(wires.carries());
  end.drive(false);
  EXPECT_FALSE(wires.busy());
}

constexpr std::array<LineFormat, 4> kFormats{LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1,
                                             LineFormat::k8O1};

TEST(Wires, AByteTakesTenBitsIn8N1AndElevenInTheOtherFormats) {
  for (const std::uint32_t baud : kBaudRates) {
    for (const LineFormat format : kFormats) {
      const std::int64_t bits = format == LineFormat::k8N1 ? 10 : 11;
      VirtualClock clock;
      Wires wires(clock);
      Master sender(wires, {baud, format}, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
      EXPECT_EQ(sender.takes(1), nanoseconds(bits * 1'000'000'000 / baud));
      Listener listener(wires, baud, format);
      const std::vector<std::uint8_t> bytes(100, 0x55);
      sender.send(bytes.data(), bytes.size());
      wires.run_for(std::chrono::seconds(2));
      ASSERT_EQ(listener.heard.size(), 100U) << baud;
      // Receivers ignore a second stop bit, so they get a byte at the end of its first stop bit.
      const double first = has_parity(format) ? 11e9 / baud : 10e9 / baud;
      const double last = 99e9 * static_cast<double>(bits) / baud + first;
      EXPECT_NEAR(static_cast<double>(listener.heard.front().at.count()), first, 1.0) << baud;
      EXPECT_NEAR(static_cast<double>(listener.heard.back().at.count()), last, 2.0) << baud;
    }
  }
}

TEST(Wires, OnlyReceiversWithTheSendersParityReceiveAllBytesWithoutError) {
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

TEST(Wires, DamagedBytesOfTheMasterArriveWithParityErrorsAndTheOthersAreGood) {
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

// As in an arbitration. A receiver gets one byte, and observers hear of both senders.
TEST(Wires, EqualBytesAtTheSameTimeMergeAndOneGoesOnWithoutTheOther) {
  for (const bool first_stops : {false, true}) {
    VirtualClock clock;
    Wires wires(clock);
    Listener listener(wires, 9600);
    std::array<Sender, 2> senders;
    std::array<WireEnd*, 2> ends{};
    WiresRecorder recorder;
    wires.observe(recorder);
    for (std::size_t i = 0; i < senders.size(); ++i) {
      ends[i] = &wires.attach(senders[i]);
      ends[i]->drive(true);
    }
    for (WireEnd* const end : ends) {
      end->put({0xFF, {9600}});
    }
    EXPECT_TRUE(ends[0]->low());
    wires.run_for(std::chrono::microseconds(500));
    EXPECT_FALSE(ends[0]->low());
    ends[first_stops ? 0 : 1]->drive(false);
    wires.run_for(milliseconds(10));
    ASSERT_EQ(listener.heard.size(), 1U);
    EXPECT_EQ(listener.heard[0].byte, 0xFF);
    EXPECT_EQ(listener.heard[0].status, ByteStatus::Good);
    ASSERT_EQ(recorder.bytes.size(), 1U);
    EXPECT_EQ(recorder.bytes[0].station, first_stops ? 2U : 1U);
  }
}

}  // namespace
}  // namespace ex9000::sim
