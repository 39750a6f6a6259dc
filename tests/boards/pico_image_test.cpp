// Tests the images for the Pico in the emulator, for example the pins, the inputs, the line format, and the
// replies with their turn-around times.
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <set>
#include <string>

#include "boards/pico/board.hpp"
#include "tests/boards/pico_image.hpp"

namespace ex9000::pico {
namespace {

TEST_F(PicoImage, NoOutputIsEnergisedBeforeTheSettingsAreRead) {
  begin();
  bench_.power(false);
  bench_.power(true);
  std::set<std::uint16_t> driven;
  for (int i = 0; i < 1500; ++i) {
    bench_.run_for(std::chrono::microseconds(100));
    driven.insert(bench_.outputs());
  }
  EXPECT_EQ(driven, (std::set<std::uint16_t>{0, kPowerOnValue}));
}

TEST_F(PicoImage, TheChipDrivesOnlyTheLineTheStatusLedAndTheOutputsOfTheModel) {
  constexpr std::uint32_t kTransmit = 1U << board::kUartPins.first_pin;
  constexpr std::uint32_t kOfEveryModel = kTransmit | board::kDriverEnable.mask() | board::kStatusLed.mask();
  begin("EX9043D-M");
  std::uint32_t outputs = 0;
  for (const auto& group : board::kOutputs) {
    outputs |= group.mask();
  }
  EXPECT_EQ(number("driven"), kOfEveryModel | outputs);
  begin("EX9052D");  // has no outputs
  EXPECT_EQ(number("driven"), kOfEveryModel);
}

TEST_F(PicoImage, OnlyTheFirstCoreRunsAndInterruptsDoNotNest) {
  begin();
  EXPECT_EQ(ask("$01M"), "!019043M\r");
  const auto counts = bench_.counts();
  EXPECT_EQ(counts.at("secondCoreResets"), 1) << "the image must reset the second core once";
  EXPECT_EQ(counts.at("secondCoreOff"), 0) << "a debug probe cannot connect to a second core in reset";
  EXPECT_EQ(counts.at("depth"), 1);
}

TEST_F(PicoImage, TheDriverIsOnForAllBitsOfAReplyAndGoesOffWithinACharacter) {
  for (const std::uint32_t baud : kBaudRates) {
    for (const char* echo : {"on", "off"}) {
      SCOPED_TRACE(std::to_string(baud) + " baud, echo " + echo);
      begin("EX9043D-M", baud);
      bench_.execute(std::string("echo ") + echo);
      EXPECT_NEAR(static_cast<double>(bench_.counts().at("uart")), baud, baud / 1000.0);
      constexpr int kRequests = 20;
      for (int i = 0; i < kRequests; ++i) {
        ASSERT_EQ(ask("$01M"), "!019043M\r");
      }
      const auto counts = bench_.counts();
      EXPECT_EQ(counts.at("drives"), kRequests);
      EXPECT_EQ(counts.at("lost"), 0);
      EXPECT_EQ(counts.at("early"), 0);
      EXPECT_EQ(counts.at("late"), 0);
      EXPECT_EQ(counts.at("framing"), 0);
    }
  }
}

TEST_F(PicoImage, AModuleRepliesInItsStoredLineFormatAndIgnoresAMasterWithAnotherParity) {
  const Model& model = *find_model("EX9043D-M");
  const std::map<LineFormat, long> line_control{
      {LineFormat::k8N2, 0x68}, {LineFormat::k8E1, 0x66}, {LineFormat::k8O1, 0x62}};
  for (const auto& [format, value] : line_control) {
    SCOPED_TRACE(value);
    Settings settings = Settings::factory(model);
    settings.protocol = Protocol::Ascii;
    settings.baud_code = with_line_format(settings.baud_code, format);
    bench_.begin_anew(model, &settings);
    bench_.set_format(format);
    bench_.power(true);
    bench_.run_for(kComingUp);
    EXPECT_EQ(bench_.counts().at("lineControl"), value);
    EXPECT_EQ(ask("$01M"), "!019043M\r");
    const LineFormat other = format == LineFormat::k8O1 ? LineFormat::k8E1 : LineFormat::k8O1;
    bench_.set_format(other);
    EXPECT_EQ(ask("$01M"), "");
    bench_.set_format(format);
    ask("");  // if the CR was damaged, the module still waits for a CR
    const std::string damaged_bytes = ask("~01X030E");
    EXPECT_GT(std::stoul(damaged_bytes.substr(3), nullptr, 16), 0U);
    EXPECT_EQ(ask("$01M"), "!019043M\r");
    for (const char* wrong : {"lost", "early", "late", "framing", "parity"}) {
      EXPECT_EQ(bench_.counts().at(wrong), 0) << wrong;
    }
  }
}

TEST_F(PicoImage, AReplyBeginsOneCharacterAfterTheRequest) {
  constexpr nanoseconds kTolerance = std::chrono::microseconds(60);
  for (const std::uint32_t baud : {9600U, 115200U}) {
    begin("EX9043D-M", baud);
    const nanoseconds bit(1'000'000'000 / baud);
    const nanoseconds waited = turn_around(bench_, text("$01M\r"), bit);
    EXPECT_GE(waited, 10 * bit) << baud;
    EXPECT_LE(waited, 10 * bit + kTolerance) << baud;
  }
}

/// While a store runs, the wake timer wakes the main loop, which polls the memory. The tick occurs only every
/// 10 ms.
TEST_F(PicoImage, AReplyToAStoreBeginsWithoutWaitingForTheTick) {
  begin("EX9043D-M", 115200);
  const nanoseconds bit(1'000'000'000 / 115200);
  bench_.run_for(milliseconds(1000));  // until no sector is left to erase
  for (int i = 0; i < 10; ++i) {
    const nanoseconds waited = turn_around(bench_, text(i % 2 == 0 ? "~01OVALVE\r" : "~01OPUMP\r"), bit);
    EXPECT_LE(waited, milliseconds(5)) << i;
  }
}

TEST_F(PicoImage, AModbusReplyBeginsAfterTheSilenceOfThreeAndAHalfCharacters) {
  constexpr nanoseconds kTolerance = std::chrono::microseconds(60);
  const Model& model = *find_model("EX9043D-M");
  Settings settings = Settings::factory(model);
  settings.protocol = Protocol::ModbusRtu;
  bench_.begin_anew(model, &settings);
  bench_.power(true);
  bench_.run_for(kComingUp);
  const nanoseconds bit(1'000'000'000 / 9600);
  const nanoseconds waited = turn_around(bench_, {1, 1, 0, 0, 0, 16, 0x3D, 0xC6}, bit);
  EXPECT_GE(waited, bit * 77 / 2);
  EXPECT_LE(waited, bit * 77 / 2 + kTolerance);
}

TEST_F(PicoImage, TheModuleCountsEveryPulseOfEightInputsDuringContinuousRequests) {
  begin("EX9052D", 115200);
  constexpr unsigned kPulses = 1500;
  for (unsigned channel = 0; channel < 8; ++channel) {
    bench_.execute("train " + std::to_string(board::kInputs[0].first_pin + channel) + " " +
                   std::to_string(kPulses) + " " + std::to_string(100'000 + 7'000 * channel));
  }
  const nanoseconds end = bench_.now() + milliseconds(500);
  while (bench_.now() < end) {
    ASSERT_EQ(ask("$01M"), "!019052\r");
  }
  for (unsigned channel = 0; channel < 8; ++channel) {
    EXPECT_EQ(ask("#01" + std::to_string(channel)), "!0101500\r");
  }
  EXPECT_EQ(bench_.counts().at("depth"), 1);
}

// wire.md section 2: a reset clears counters and latches, and the level of the inputs at reset is the
// baseline. The pull-up of an open input takes some time to change the level of the pin.
TEST_F(PicoImage, AnOpenInputHasNoEdgeAtAReset) {
  begin("EX9052D");
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(ask("$01L0"), "!000000\r");
    EXPECT_EQ(ask("$01L1"), "!000000\r");
    for (unsigned channel = 0; channel < 8; ++channel) {
      EXPECT_EQ(ask("#01" + std::to_string(channel)), "!0100000\r") << channel;
    }
    bench_.reset();
    bench_.run_for(kComingUp);
  }
}

// A debug probe resets only the processor. The PLL, the watchdog and the pins then keep their state until the
// image starts.
TEST_F(PicoImage, AModuleStartsAfterAResetOfOnlyTheProcessor) {
  begin();
  EXPECT_EQ(ask("@01FFFF"), ">\r");
  EXPECT_EQ(bench_.outputs(), 0xFFFF);
  bench_.execute("reset-processor");
  EXPECT_EQ(bench_.outputs(), 0xFFFF);
  const nanoseconds end = bench_.now() + kComingUp;
  while (bench_.outputs() != 0 && bench_.now() < end) {
    bench_.run_for(std::chrono::microseconds(100));
  }
  std::set<std::uint16_t> driven;
  while (bench_.now() < end) {
    driven.insert(bench_.outputs());
    bench_.run_for(std::chrono::microseconds(100));
  }
  EXPECT_EQ(driven, (std::set<std::uint16_t>{0, kPowerOnValue})) << "all outputs go off first";
  EXPECT_EQ(bench_.outputs(), kPowerOnValue);
  EXPECT_EQ(ask("$01M"), "!019043M\r");
  bench_.run_for(2 * kWatchdogPeriod);
  EXPECT_EQ(ask("$01M"), "!019043M\r");
  EXPECT_EQ(bench_.counts().at("timeouts"), 0);
}

// The LED on a Pico W is connected to the radio chip, so the image for a Pico W drives an external LED at
// GP22 instead.
TEST_F(PicoImage, TheStatusLedOfAPicoWUsesAPinThatTheRadioDoesNotUse) {
  constexpr std::uint32_t kLedOfPicoW = 1U << 22;
  constexpr std::uint32_t kRadio = 1U << 23 | 1U << 24 | 1U << 25 | 1U << 29;
  bench_.begin_with("build/pico-w/EX9055D.bin");
  bench_.power(true);
  bench_.run_for(kComingUp);
  EXPECT_EQ(ask("$01M"), "!019055\r");
  EXPECT_EQ(bench_.levels() & (kLedOfPicoW | kRadio), kLedOfPicoW);
  EXPECT_EQ(bench_.counts().at("drives"), 1);
}

}  // namespace
}  // namespace ex9000::pico
