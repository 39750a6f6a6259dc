// Tests an image for the Pico-Relay-B in the emulator: its relays, its other pins, and its automatic
// transceiver.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/boards/pico_image.hpp"

namespace ex9000::pico {
namespace {

constexpr const char* kModel = "EX9068D-M";
constexpr std::uint32_t kRelays = 0x3F'C000;  // GPIO14 to GPIO21
constexpr std::uint32_t kBuzzer = 1U << 6U;
constexpr std::uint32_t kRgbLed = 1U << 13U;
constexpr std::uint32_t kLed = 1U << 25U;
constexpr std::uint32_t kTransmit = 1U << 0U;

class PicoRelayB : public PicoImage {};

TEST_F(PicoRelayB, Relay1IsOnGpio21AndRelay8OnGpio14) {
  begin(kModel);
  for (unsigned channel = 0; channel < 8; ++channel) {
    constexpr const char* kDigits = "0123456789ABCDEF";
    const unsigned value = 1U << channel;
    EXPECT_EQ(ask(std::string("@01") + kDigits[value >> 4U] + kDigits[value & 0xFU]), ">\r");
    EXPECT_EQ(bench_.levels() & kRelays, 1U << (21U - channel)) << channel;
  }
}

TEST_F(PicoRelayB, NoRelayIsOnBeforeTheSettingsAreRead) {
  constexpr std::uint32_t kPowerOnRelays = 0x16'8000;  // 0x5A, channel 0 on GPIO21
  begin(kModel);
  for (const char* how : {"power", "reset"}) {
    if (std::string(how) == "power") {
      bench_.power(false);
      bench_.power(true);
    } else {
      bench_.reset();
    }
    bool on = false;
    for (int i = 0; i < 1000; ++i) {
      bench_.run_for(std::chrono::microseconds(100));
      const std::uint32_t relays = bench_.levels() & kRelays;
      on = on || relays != 0;
      ASSERT_EQ(relays, on ? kPowerOnRelays : 0U) << how;
    }
    EXPECT_TRUE(on) << how;
  }
}

TEST_F(PicoRelayB, TheChipDrivesOnlyTheLineTheRelaysAndTheLedSoThatTheBuzzerAndTheRgbLedStayLow) {
  begin(kModel);
  EXPECT_EQ(number("driven"), kTransmit | kRelays | kLed);
  EXPECT_EQ(bench_.levels() & (kBuzzer | kRgbLed | kLed), kLed);
  EXPECT_EQ(ask("@01FF"), ">\r");
  EXPECT_EQ(bench_.levels() & (kBuzzer | kRgbLed | kRelays), kRelays);
}

TEST_F(PicoRelayB, TheModuleAnswersAtEveryRateWithOrWithoutAnEcho) {
  for (const std::uint32_t baud : kBaudRates) {
    for (const char* echo : {"on", "off"}) {
      SCOPED_TRACE(std::to_string(baud) + " baud, echo " + echo);
      begin(kModel, baud);
      bench_.execute(std::string("echo ") + echo);
      for (int i = 0; i < 20; ++i) {
        ASSERT_EQ(ask("$01M"), "!019068D-M\r");
      }
      EXPECT_EQ(ask("~01X030E"), "!010000\r") << "damaged bytes";
    }
  }
}

/// A request that begins as soon as the last stop bit of the reply has ended.
TEST_F(PicoRelayB, ARequestDirectlyAfterAReplyIsReceived) {
  begin(kModel, 115200);
  for (int i = 0; i < 20; ++i) {
    bench_.send(text("$01M\r"));
    const play::Bytes reply = bench_.receive(11, kPatience);
    ASSERT_EQ(reply, text("!019068D-M\r")) << i;
    bench_.execute("await-release 1000000");
  }
}

/// README.md in the folder of the board warns of this.
TEST_F(PicoRelayB, TheTransceiverKeepsTheLineLowUntilTheImageConfiguresTheTransmitPin) {
  begin(kModel);
  bench_.reset();
  bench_.run_for(milliseconds(20));
  EXPECT_EQ(bench_.levels() & kTransmit, 0U);
  bench_.run_for(milliseconds(20));
  EXPECT_EQ(bench_.levels() & kTransmit, kTransmit);
  EXPECT_EQ(bench_.heard(), play::Bytes{0}) << "a break";
}

}  // namespace
}  // namespace ex9000::pico
