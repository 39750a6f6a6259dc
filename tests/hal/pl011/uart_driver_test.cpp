// Tests the UART driver and its RS-485 driver enable on the wires of a LineBench. The LineBench records the
// sent characters and the times at which the RS-485 driver is switched on and off.
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <tuple>
#include <vector>

#include "firmware/model/baud.hpp"
#include "hal/pins/single_pins.hpp"
#include "hal/stellaris/gpio.hpp"
#include "hal/stellaris/one_shot_timer.hpp"
#include "hal/stellaris/uart.hpp"
#include "tests/mcu_model/driver_bench.hpp"
#include "tests/mcu_model/line_bench.hpp"

namespace ex9000::registers {
namespace {

using hal::stellaris::Family;
using hal::stellaris::Gpio;
using hal::stellaris::OneShotTimer;
using hal::stellaris::Pin;
using hal::stellaris::Port;
using hal::stellaris::Uart;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr std::uint32_t kHertz = 50'000'000;
constexpr Pin kEnable{Port::A, 6};
constexpr hal::NoPin kAutomatic{};
using EndTimer = OneShotTimer<1, kHertz / 1'000'000>;

template <const auto& enable>
class UartBenchWith : public DriverBench {
 public:
  struct Received {
    std::uint8_t byte;
    ByteStatus status;
    bool while_sending;
  };

  UartBenchWith(const Chip& chip, std::uint32_t baud, LineFormat format)
      : DriverBench(chip), line(timeline, pins.at('A', 1), pins.at('A', 6), pins.at('A', 0)) {
    uart.start();
    if (chip.port_control) {
      Gpio(Port::A).make_peripheral<Family::Tm4c, 0x03, 1>();
    } else {
      Gpio(Port::A).make_peripheral<Family::Lm3s, 0x03, 1>();
    }
    EndTimer::start();
    serve(kUart0Interrupt, [this] {
      uart.on_interrupt([this](std::uint8_t byte, ByteStatus status) {
        received.push_back({byte, status, uart.sending()});
      });
    });
    serve(kTimer1Interrupt, [this] {
      if (EndTimer::take_expiry()) {
        uart.on_end_timer();
      }
    });
    line.set_baud(baud);
    line.set_format(format);
    uart.open(baud, format);
  }

  /// Sends bytes and waits until the RS-485 driver is off.
  void send(const std::vector<std::uint8_t>& bytes) {
    uart.send({bytes.data(), bytes.size()});
    EXPECT_TRUE(uart.sending());
    const Instant patience = now() + 4 * static_cast<unsigned>(bytes.size() + 2) * line.character_time();
    while (uart.sending() && now() < patience) {
      mcu.run_for(line.bit_time() / 4);
    }
    EXPECT_FALSE(uart.sending());
  }

  LineBench line;
  Uart<0, kHertz, enable, EndTimer> uart;
  std::vector<Received> received;
};
using UartBench = UartBenchWith<kEnable>;

std::vector<std::uint8_t> some_bytes(std::size_t count) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i * 37 + 11));
  }
  return bytes;
}

constexpr std::array<LineFormat, 4> kFormats{LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1,
                                             LineFormat::k8O1};

std::string name_of(LineFormat format) {
  constexpr std::array<const char*, 4> kNames{"8N1", "8N2", "8E1", "8O1"};
  return kNames.at(static_cast<std::size_t>(format));
}

class Sending : public testing::TestWithParam<std::tuple<bool, std::uint32_t, LineFormat>> {
 protected:
  [[nodiscard]] const Chip& chip() const { return std::get<0>(GetParam()) ? kTm4c123 : kLm3s6965; }
  [[nodiscard]] std::uint32_t baud() const { return std::get<1>(GetParam()); }
  [[nodiscard]] LineFormat format() const { return std::get<2>(GetParam()); }
  /// Returns the duration of a character in bits: 10 in 8N1, 11 in the other formats
  /// (firmware/extensions.md).
  [[nodiscard]] int bits() const { return format() == LineFormat::k8N1 ? 10 : 11; }
  [[nodiscard]] Instant character() const { return Instant(bits() * 1'000'000'000'000 / baud()); }

  /// Checks the conditions that must always hold: all bytes are on the line with correct parity and a correct
  /// first stop bit. The RS-485 driver is switched on once, before the first byte, and stays on at least
  /// until the end of the last stop bit.
  void expect_whole(const UartBench& bench, const std::vector<std::uint8_t>& bytes) {
    ASSERT_EQ(bench.line.heard.size(), bytes.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      EXPECT_EQ(bench.line.heard[i].byte, bytes[i]);
      EXPECT_TRUE(bench.line.heard[i].good);
    }
    ASSERT_EQ(bench.line.drives.size(), 1U) << "the RS-485 driver must be switched on and off exactly once";
    EXPECT_LT(bench.line.drives[0].from, bench.line.heard.front().started);
    EXPECT_EQ(bench.line.bits_lost, 0U);
    // The clock of the microcontroller determines the length of the last stop bit.
    const Instant bit = bench.mcu.uart0.bit_time();
    EXPECT_GE(bench.line.drives[0].to, bench.line.heard.back().started + bits() * bit);
  }
};

TEST_P(Sending, TheDriverIsOnForAllBytesAndOffWithinOneCharacterAfterThem) {
  for (const std::size_t size : {1U, 2U, 3U, 9U, 60U, 256U}) {
    for (const Instant latency :
         {Instant(0), Instant(microseconds(2)), Instant(microseconds(10)), 3 * character() / 10}) {
      for (const Instant phase : {Instant(0), Instant(1'230'000)}) {
        SCOPED_TRACE(std::to_string(size) + " bytes, latency " + std::to_string(latency.count()) + " ps");
        UartBench bench(chip(), baud(), format());
        bench.mcu.core.set_latency(latency);
        bench.mcu.run_for(character() + phase);
        const std::vector<std::uint8_t> bytes = some_bytes(size);
        bench.send(bytes);
        expect_whole(bench, bytes);
        EXPECT_LE(bench.line.drives[0].to, bench.line.heard.back().started + 2 * character());
        // The characters follow each other without a gap.
        const Instant bit = bench.mcu.uart0.bit_time();
        EXPECT_NEAR(
            static_cast<double>((bench.line.heard.back().started - bench.line.heard.front().started).count()),
            static_cast<double>((static_cast<int>(size - 1) * bits() * bit).count()), 1e6);
      }
    }
    if (size > 9 && baud() < 9600) {
      break;  // 256 bytes would take seconds of virtual time and test nothing new
    }
  }
}

TEST_P(Sending, TheDriverIsNotSwitchedOffEarlyIfInterruptsAreLate) {
  for (const int tenths : {8, 11, 15, 24}) {
    UartBench bench(chip(), baud(), format());
    bench.mcu.core.set_latency(tenths * character() / 10);
    const std::vector<std::uint8_t> bytes = some_bytes(5);
    bench.send(bytes);
    expect_whole(bench, bytes);
  }
}

TEST_P(Sending, TheEchoOfTheSentBytesIsNotReceived) {
  for (const Instant latency : {Instant(0), Instant(microseconds(30))}) {
    UartBench bench(chip(), baud(), format());
    bench.mcu.core.set_latency(latency);
    const std::vector<std::uint8_t> bytes = some_bytes(20);
    bench.send(bytes);
    bench.mcu.run_for(3 * character());
    EXPECT_TRUE(bench.received.empty());
    bench.line.send({0x5A});
    bench.mcu.run_for(3 * character());
    ASSERT_EQ(bench.received.size(), 1U) << "expected only the byte after the echo";
    EXPECT_EQ(bench.received[0].byte, 0x5A);
    EXPECT_EQ(bench.received[0].status, ByteStatus::Good);
  }
}

/// The bench keeps the driver on, like an automatic transceiver with an echo.
TEST_P(Sending, WithoutADriverEnableTheUartSendsAndIgnoresTheEchoUntilTheEndOfTheLastStopBit) {
  UartBenchWith<kAutomatic> bench(chip(), baud(), format());
  bench.pins.at('A', 6).drive(End::Board, Drive::High);
  bench.mcu.run_for(character());
  for (const std::uint8_t byte : std::array<std::uint8_t, 3>{0x00, 0x55, 0xFF}) {
    bench.line.heard.clear();
    bench.received.clear();
    bench.send({byte, byte});
    ASSERT_EQ(bench.line.heard.size(), 2U);
    const Instant end = bench.line.heard.back().started + bits() * bench.mcu.uart0.bit_time();
    EXPECT_GE(bench.now(), end);
    EXPECT_LE(bench.now(), end + character());
    EXPECT_TRUE(bench.received.empty());
    bench.line.send({byte});
    bench.mcu.run_for(2 * character());
    ASSERT_EQ(bench.received.size(), 1U);
    EXPECT_EQ(bench.received[0].byte, byte);
    EXPECT_EQ(bench.received[0].status, ByteStatus::Good);
  }
}

TEST_P(Sending, ManyRepliesCanBeSentInSequence) {
  UartBench bench(chip(), baud(), format());
  for (int i = 0; i < 300; ++i) {  // more than 2^8, so that an 8-bit count would wrap
    bench.line.heard.clear();
    bench.line.drives.clear();
    const std::vector<std::uint8_t> bytes = some_bytes(1 + static_cast<std::size_t>(i) % 3);
    bench.send(bytes);
    expect_whole(bench, bytes);
  }
}

TEST_P(Sending, ReceivesTheBytesThatTheMasterSends) {
  UartBench bench(chip(), baud(), format());
  const std::vector<std::uint8_t> bytes = some_bytes(256);
  bench.line.send(bytes);
  bench.mcu.run_for(258 * character());
  ASSERT_EQ(bench.received.size(), bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_EQ(bench.received[i].byte, bytes[i]);
    EXPECT_EQ(bench.received[i].status, ByteStatus::Good);
  }
  EXPECT_TRUE(bench.line.drives.empty());
}

INSTANTIATE_TEST_SUITE_P(AtAllRatesAndFormats, Sending,
                         testing::Combine(testing::Bool(), testing::ValuesIn(kBaudRates),
                                          testing::ValuesIn(kFormats)),
                         [](const auto& each) {
                           return std::string(std::get<0>(each.param) ? "Tm4c" : "Lm3s") +
                                  std::to_string(std::get<1>(each.param)) + "At" +
                                  name_of(std::get<2>(each.param));
                         });

class Receiving : public testing::TestWithParam<LineFormat> {
 protected:
  static constexpr std::uint32_t kBaud = 9600;

  [[nodiscard]] Instant character() const { return bench.line.character_time(); }

  std::vector<ByteStatus> statuses() {
    std::vector<ByteStatus> result;
    for (const UartBench::Received& each : bench.received) {
      result.push_back(each.status);
    }
    return result;
  }

  UartBench bench{kLm3s6965, kBaud, GetParam()};
};
class ReceivingParity : public Receiving {};

/// PL011 TRM, 3.3.7: WLEN is in bits 6:5, STP2 is bit 3, EPS is bit 2, and PEN is bit 1. Bit 4, FEN, is 0.
TEST_P(Receiving, TheLineControlRegisterSelectsTheFormat) {
  constexpr std::array<std::uint32_t, 4> kLineControl{0x60, 0x68, 0x66, 0x62};
  EXPECT_EQ(bench.mcu.uart0.line_control(), kLineControl.at(static_cast<std::size_t>(GetParam())));
}

TEST_P(Receiving, ALowStopBitIsAFramingError) {
  bench.line.set_format(has_parity(GetParam()) ? GetParam() : LineFormat::k8N1);
  bench.line.send_one(Character{0x55, false, 0});
  bench.mcu.run_for(4 * character());
  bench.line.send({0x41});
  bench.mcu.run_for(2 * character());
  EXPECT_EQ(statuses(), (std::vector<ByteStatus>{ByteStatus::FramingError, ByteStatus::Good}));
  EXPECT_EQ(bench.received[1].byte, 0x41);
}

TEST_P(Receiving, ALongBreakIsReportedOnce) {
  bench.line.send_one(Character{0, true, 50});
  bench.line.send({0x42});
  bench.mcu.run_for(8 * character());
  EXPECT_EQ(statuses(), (std::vector<ByteStatus>{ByteStatus::Break, ByteStatus::Good}));
  EXPECT_EQ(bench.received[1].byte, 0x42);
}

TEST_P(Receiving, OneOverrunIsReportedIfBytesAreLostWhileInterruptsAreHeld) {
  bench.mcu.core.hold(true);
  bench.line.send({1, 2, 3});
  bench.mcu.run_for(4 * character());
  bench.mcu.core.hold(false);
  bench.mcu.run_for(character());
  bench.line.send({4, 5});
  bench.mcu.run_for(3 * character());
  EXPECT_EQ(bench.mcu.uart0.overruns(), 2U);
  EXPECT_EQ(statuses(), (std::vector<ByteStatus>{ByteStatus::Good, ByteStatus::Overrun, ByteStatus::Good}));
}

TEST_P(Receiving, NoByteIsLostIfTheInterruptIsLateByLessThanOneCharacter) {
  bench.mcu.core.set_latency(95 * character() / 100);
  const std::vector<std::uint8_t> bytes = some_bytes(100);
  bench.line.send(bytes);
  bench.mcu.run_for(102 * character());
  EXPECT_EQ(bench.mcu.uart0.overruns(), 0U);
  EXPECT_EQ(bench.received.size(), bytes.size());
}

TEST_P(Receiving, ASpikeIsNotReceivedAsAByte) {
  bench.mcu.run_for(character());
  bench.pins.at('A', 0).drive(End::Board, Drive::Low);
  bench.mcu.run_for(microseconds(20));
  bench.pins.at('A', 0).drive(End::Board, Drive::High);
  bench.mcu.run_for(2 * character());
  EXPECT_TRUE(bench.received.empty());
}

INSTANTIATE_TEST_SUITE_P(InAllFormats, Receiving, testing::ValuesIn(kFormats),
                         [](const auto& format) { return name_of(format.param); });

TEST_P(ReceivingParity, AByteWithWrongParityIsAParityError) {
  bench.line.send({0x43});
  bench.line.send_one(Character{0x43, true, 0, true});
  bench.line.send({0x43});
  bench.mcu.run_for(5 * character());
  EXPECT_EQ(statuses(),
            (std::vector<ByteStatus>{ByteStatus::Good, ByteStatus::ParityError, ByteStatus::Good}));
}

TEST_P(ReceivingParity, ALowStopBitAfterWrongParityIsAFramingError) {
  bench.line.send_one(Character{0x55, false, 0, true});
  bench.mcu.run_for(4 * character());
  EXPECT_EQ(statuses(), std::vector<ByteStatus>{ByteStatus::FramingError});
}

TEST_P(ReceivingParity, AnOverrunIsReportedEvenIfTheNextByteHasWrongParity) {
  bench.mcu.core.hold(true);
  bench.line.send({1, 2});
  bench.mcu.run_for(3 * character());
  bench.mcu.core.hold(false);
  bench.mcu.run_for(character());
  bench.line.send_one(Character{3, true, 0, true});
  bench.mcu.run_for(2 * character());
  EXPECT_EQ(statuses(), (std::vector<ByteStatus>{ByteStatus::Good, ByteStatus::Overrun}));
}

TEST_P(ReceivingParity, EachByteOfAMasterWithTheOppositeParityIsAParityError) {
  bench.line.set_format(GetParam() == LineFormat::k8E1 ? LineFormat::k8O1 : LineFormat::k8E1);
  bench.line.send(some_bytes(256));
  bench.mcu.run_for(258 * character());
  EXPECT_EQ(statuses(), std::vector<ByteStatus>(256, ByteStatus::ParityError));
}

INSTANTIATE_TEST_SUITE_P(InBothFormats, ReceivingParity, testing::Values(LineFormat::k8E1, LineFormat::k8O1),
                         [](const auto& format) { return name_of(format.param); });

class ReceivingWithoutParity : public Receiving {};

/// A receiver checks only the first stop bit.
TEST_P(ReceivingWithoutParity, AMasterWithAnotherNumberOfStopBitsCanSendAndReceive) {
  bench.line.set_format(GetParam() == LineFormat::k8N1 ? LineFormat::k8N2 : LineFormat::k8N1);
  const std::vector<std::uint8_t> bytes = some_bytes(256);
  bench.line.send(bytes);
  bench.mcu.run_for(258 * character());
  EXPECT_EQ(statuses(), std::vector<ByteStatus>(256, ByteStatus::Good));
  bench.send(bytes);
  ASSERT_EQ(bench.line.heard.size(), bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_EQ(bench.line.heard[i].byte, bytes[i]);
    EXPECT_TRUE(bench.line.heard[i].good);
  }
}

TEST_P(ReceivingWithoutParity, AParityBitOf0IsAFramingError) {
  bench.line.set_format(LineFormat::k8E1);
  bench.line.send({0x55});  // its parity bit is 0; without parity, the receiver expects a stop bit there
  bench.mcu.run_for(2 * character());
  EXPECT_EQ(statuses(), std::vector<ByteStatus>{ByteStatus::FramingError});
}

INSTANTIATE_TEST_SUITE_P(InBothFormats, ReceivingWithoutParity,
                         testing::Values(LineFormat::k8N1, LineFormat::k8N2),
                         [](const auto& format) { return name_of(format.param); });

}  // namespace
}  // namespace ex9000::registers
