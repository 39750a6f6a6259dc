// Tests the images for the Pico in the emulator: the pins, replies and their turn-around times, resets,
// faults, and the EEPROM. To make an image hang, a test changes its code in RAM. After the reset, the second
// stage copies the image from the flash again.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

#include "boards/pico/board.hpp"
#include "firmware/model/baud.hpp"
#include "tests/rp2040/pico_bench.hpp"

namespace ex9000::pico {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr milliseconds kComingUp{100};  ///< wire.md section 2
constexpr milliseconds kPatience{100};
/// The longest period of the module's watchdog: wire.md 6.
constexpr milliseconds kWatchdogPeriod{1600};

constexpr std::uint32_t kVectors = 0x2000'0000;
constexpr unsigned kSystemTick = 15;
constexpr unsigned kFirstInterrupt = 16;

constexpr unsigned kUart0 = 20;
constexpr unsigned kBranchToItself = 0xE7FE;
constexpr unsigned kUndefined = 0xDE00;
constexpr unsigned kReturn = 0x4770;  // BX LR

play::Bytes text(const std::string& characters) { return {characters.begin(), characters.end()}; }

class PicoImage : public testing::Test {
 protected:
  explicit PicoImage(Memory memory = Memory::Flash) : bench_(memory) {}

  static constexpr std::uint16_t kPowerOnValue = 0x5A5A;
  static constexpr std::uint16_t kSafeValue = 0xA5A4;

  void begin(const char* designation = "EX9043D-M", std::uint32_t baud = 9600) {
    const Model& model = *find_model(designation);
    Settings settings = Settings::factory(model);
    settings.protocol = Protocol::Ascii;
    while (baud_rate(settings.baud_code) != baud) {
      settings.baud_code = settings.baud_code == kLastBaudCode
                               ? kFirstBaudCode
                               : static_cast<std::uint8_t>(settings.baud_code + 1U);
    }
    if (model.outputs != 0) {
      settings.power_on_value = kPowerOnValue;
      settings.safe_value = kSafeValue;
    }
    bench_.begin_anew(model, &settings);
    bench_.set_baud(baud);
    bench_.power(true);
    bench_.run_for(kComingUp);
  }

  std::string ask(const std::string& request) {
    bench_.send(text(request + "\r"));
    const play::Bytes reply = bench_.receive(64, kPatience);
    return {reply.begin(), reply.end()};
  }

  std::uint32_t number(const std::string& command) {
    return static_cast<std::uint32_t>(std::stoul(bench_.execute(command)));
  }
  void put(std::uint32_t address, unsigned instruction) {
    bench_.execute("write " + std::to_string(address) + " " + std::to_string(instruction));
  }
  /// Replaces the first instruction of an exception's handler.
  void replace_handler(unsigned exception, unsigned instruction) {
    put(number("read " + std::to_string(kVectors + 4U * exception)) & ~1U, instruction);
  }
  /// Replaces the instruction at which the main loop continues. The processor must be asleep when a test
  /// calls this function. It sleeps most of the time.
  void replace_main_loop(unsigned instruction) { put(number("pc"), instruction); }

  PicoBench bench_;
};

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

TEST_F(PicoImage, TheChipDrivesOnlyTheOutputsOfTheModelTheLineAndTheStatusLed) {
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
  EXPECT_EQ(counts.at("secondCoreOff"), 1);
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

TEST_F(PicoImage, AModuleRepliesInItsStoredFormatAndIgnoresAMasterWithAnotherParity) {
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
    ask("");  // the CR was damaged, so the frame may still be open
    const std::string damaged_bytes = ask("~01X030E");
    EXPECT_GT(std::stoul(damaged_bytes.substr(3), nullptr, 16), 0U);
    EXPECT_EQ(ask("$01M"), "!019043M\r");
    for (const char* wrong : {"lost", "early", "late", "framing", "parity"}) {
      EXPECT_EQ(bench_.counts().at(wrong), 0) << wrong;
    }
  }
}

TEST_F(PicoImage, TheModuleRepliesToEveryRequestWithoutPausesAt115200Baud) {
  begin("EX9043D-M", 115200);
  for (int i = 0; i < 500; ++i) {
    bench_.send(text("$01M\r"));
    const play::Bytes reply = bench_.receive(9, milliseconds(5));
    ASSERT_EQ(std::string(reply.begin(), reply.end()), "!019043M\r") << i;
  }
}

/// Returns the time from the end of a request to the start bit of the reply.
nanoseconds turn_around(PicoBench& bench, const play::Bytes& request, nanoseconds bit) {
  bench.send(request);
  const nanoseconds end = bench.now();
  bench.run_for(milliseconds(20));
  const std::string arrivals = bench.execute("arrivals");
  const nanoseconds middle_of_stop_bit(std::stoll(arrivals.substr(arrivals.find('@') + 1)));
  return middle_of_stop_bit - bit * 19 / 2 - end;
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

/// The wake timer wakes the main loop, which polls the memory. The tick occurs only every 10 ms.
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

TEST_F(PicoImage, TheModuleReportsTheLevelsOfItsInputs) {
  begin("EX9052D");
  EXPECT_EQ(ask("@01"), ">0000\r");
  const auto set_inputs = [this](std::uint32_t levels) {
    for (unsigned channel = 0; channel < 8; ++channel) {
      bench_.set_input(channel, (levels >> channel & 1U) != 0);
    }
    bench_.run_for(milliseconds(1));
  };
  set_inputs(0xB6);
  EXPECT_EQ(ask("@01"), ">B600\r");
  bench_.power(false);
  set_inputs(0x5C);
  bench_.power(true);
  bench_.run_for(kComingUp);
  EXPECT_EQ(ask("@01"), ">5C00\r") << "the levels at reset";
}

// wire.md section 2: in INIT mode, the module has address 00 and uses no checksum.
TEST_F(PicoImage, TheInitSwitchSelectsTheInitMode) {
  begin();
  EXPECT_EQ(ask("$00M"), "");
  bench_.power(false);
  bench_.set_init(true);
  bench_.power(true);
  bench_.run_for(kComingUp);
  EXPECT_EQ(ask("$00M"), "!009043M\r");
}

enum class Doing : std::uint8_t { Nothing, Receiving, Replying, Storing, Erasing };
const char* name_of(Doing doing) {
  constexpr const char* kNames[] = {"Nothing", "Receiving", "Replying", "Storing", "Erasing"};
  return kNames[static_cast<int>(doing)];
}

class HangingPicoImage : public PicoImage, public testing::WithParamInterface<Doing> {
 protected:
  static constexpr milliseconds kLongestErase{400};

  void make_it_busy() {
    switch (GetParam()) {
      case Doing::Nothing:
        break;
      case Doing::Receiving:
        bench_.execute("queue 2430314D2430314D2430314D");
        bench_.run_for(milliseconds(3));
        break;
      case Doing::Replying:
        bench_.send(text("$01M\r"));
        bench_.run_for(milliseconds(3));
        break;
      case Doing::Storing:
        bench_.execute("flash-times 45000000 3000000");  // a page program takes 3 ms
        bench_.send(text("~01OVALVE\r"));
        bench_.run_for(milliseconds(2));
        break;
      case Doing::Erasing:  // as on the first start, with a slow flash
        bench_.power(false);
        bench_.forget_erased_sectors();
        bench_.execute("flash-times " + std::to_string(nanoseconds(kLongestErase).count()) + " 3000000");
        bench_.power(true);
        bench_.run_for(kComingUp);
        break;
    }
  }

  /// Checks that the chip is reset once within the time `within` and for the reason `reason`, and that the
  /// module then works. `count` is the name of the emulator's counter for such resets.
  void expect_reset(const char* count, long reason, nanoseconds within) {
    bench_.run_for(within);
    EXPECT_EQ(bench_.counts().at(count), 1);
    EXPECT_EQ(bench_.counts().at("reason"), reason);
    EXPECT_EQ(bench_.levels() & board::kDriverEnable.mask(), 0U) << "the driver is on";
    // The boot ROM waits until the flash has ended an erase.
    bench_.run_for(kComingUp + (GetParam() == Doing::Erasing ? kLongestErase : milliseconds(0)));
    EXPECT_EQ(bench_.outputs(), kPowerOnValue);
    bench_.heard();
    ask("");
    EXPECT_EQ(ask("$012"), "!01400600\r");
    EXPECT_EQ(bench_.counts().at("timeouts") + bench_.counts().at("requests"), 1);
  }
};

constexpr long kTimeout = 1;
constexpr long kRequest = 2;

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfTheMainLoopHangs) {
  begin();
  ASSERT_EQ(ask("@01C35A"), ">\r");
  ASSERT_EQ(bench_.outputs(), 0xC35A);
  make_it_busy();
  replace_main_loop(kBranchToItself);
  expect_reset("timeouts", kTimeout, kWatchdogPeriod);
}

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfAnInterruptHangs) {
  for (const unsigned exception : {kSystemTick, kFirstInterrupt + kUart0}) {
    begin();
    make_it_busy();
    replace_handler(exception, kBranchToItself);
    bench_.execute("queue 24");  // causes a receive interrupt
    expect_reset("timeouts", kTimeout, kWatchdogPeriod);
  }
}

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfTheTickHandlerReturnsImmediately) {
  begin();
  make_it_busy();
  replace_handler(kSystemTick, kReturn);
  expect_reset("timeouts", kTimeout, kWatchdogPeriod);
}

TEST_P(HangingPicoImage, IsResetImmediatelyIfItFaults) {
  begin();
  make_it_busy();
  replace_handler(kSystemTick, kUndefined);
  expect_reset("requests", kRequest, milliseconds(11));
}

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfAFaultHandlerFaults) {
  begin();
  make_it_busy();
  constexpr unsigned kHardFault = 3;
  replace_handler(kHardFault, kUndefined);
  replace_handler(kSystemTick, kUndefined);
  expect_reset("timeouts", kTimeout, kWatchdogPeriod);
}

INSTANTIATE_TEST_SUITE_P(While, HangingPicoImage,
                         testing::Values(Doing::Nothing, Doing::Receiving, Doing::Replying, Doing::Storing,
                                         Doing::Erasing),
                         [](const auto& each) { return name_of(each.param); });

/// firmware/extensions.md, register 0x0301.
TEST_F(PicoImage, TheModuleReportsTheReasonOfEachReset) {
  const std::string ask_reason = "~01X0301";
  begin();
  EXPECT_EQ(ask(ask_reason), "!010001\r");
  for (int pass = 0; pass < 2; ++pass) {
    replace_main_loop(kBranchToItself);
    bench_.run_for(kWatchdogPeriod + kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010002\r");
    replace_handler(kSystemTick, kUndefined);
    bench_.run_for(milliseconds(11) + kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010005\r");
    bench_.reset();
    bench_.run_for(kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010004\r");
    bench_.power(false);
    bench_.power(true);
    bench_.run_for(kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010001\r");
  }
}

/// After a copy to the drive, the boot ROM uses the watchdog to reset the chip, although the watchdog has not
/// expired.
TEST_F(PicoImage, TheModuleReportsASoftwareResetAfterACopyToTheDrive) {
  begin();
  bench_.power(false);
  bench_.execute("power-after-copy");
  bench_.run_for(kComingUp);
  EXPECT_EQ(ask("~01X0301"), "!010003\r");
  replace_main_loop(kBranchToItself);
  bench_.run_for(kWatchdogPeriod + kComingUp);
  EXPECT_EQ(ask("~01X0301"), "!010002\r");
}

TEST_F(PicoImage, BytesWithoutPausesDoNotResetTheModule) {
  begin("EX9043D-M", 115200);
  const nanoseconds end = bench_.now() + 2 * kWatchdogPeriod;
  while (bench_.now() < end) {
    bench_.send(play::Bytes(500, 'U'));
    bench_.send(text("$01"));
  }
  bench_.heard();
  ask("");
  EXPECT_EQ(ask("$01M"), "!019043M\r");
  EXPECT_EQ(bench_.counts().at("timeouts") + bench_.counts().at("requests"), 0);
}

class PicoWithEeprom : public PicoImage {
 protected:
  PicoWithEeprom() : PicoImage(Memory::Eeprom) {}
};

TEST_F(PicoWithEeprom, APowerFailureDuringAStoreLeavesTheOldOrTheNewName) {
  std::map<std::string, int> names;
  for (int cut = 0; cut < 60; ++cut) {
    begin();
    ASSERT_EQ(ask("~01OOLD"), "!01\r");
    bench_.send(text("~01ONEW\r"));
    bench_.run_for(std::chrono::microseconds(500) * cut);
    bench_.power(false);
    bench_.run_for(milliseconds(10));
    bench_.power(true);
    bench_.run_for(kComingUp);
    bench_.heard();
    ++names[ask("$01M")];
  }
  EXPECT_GT(names["!01OLD\r"], 0);
  EXPECT_GT(names["!01NEW\r"], 0);
  EXPECT_EQ(names.size(), 2U);
}

/// The bytes on the bus and the programming of the page take 11 ms. Without the interrupt of the I2C master,
/// each step would wait up to 1 ms longer, until the main loop polls the memory.
TEST_F(PicoWithEeprom, AReplyToAStoreBeginsWithoutWaitingForThePollOfTheMemory) {
  begin("EX9043D-M", 115200);
  const nanoseconds bit(1'000'000'000 / 115200);
  for (int i = 0; i < 10; ++i) {
    const nanoseconds waited = turn_around(bench_, text(i % 2 == 0 ? "~01OVALVE\r" : "~01OPUMP\r"), bit);
    EXPECT_LE(waited, milliseconds(12)) << i;
  }
}

TEST_F(PicoWithEeprom, AnEepromThatBlocksTheBusDoesNotStopTheModule) {
  begin();
  bench_.execute("pin " + std::to_string(board::kI2cPins.first_pin) + " low");
  bench_.execute("absent");
  EXPECT_EQ(ask("~01OVALVE"), "?01\r");
  EXPECT_EQ(ask("$01M"), "!019043M\r");
  bench_.power(false);
  bench_.power(true);
  bench_.run_for(milliseconds(1000));
  EXPECT_EQ(bench_.counts().at("timeouts"), 0);
}

TEST_F(PicoWithEeprom, AModuleThatStartsFreesABusThatTheEepromHolds) {
  const unsigned data = board::kI2cPins.first_pin;
  begin();
  bench_.power(false);
  bench_.execute("pin " + std::to_string(data) + " low");
  bench_.power(true);
  // The EEPROM releases the data line after nine clocks, as if a reset had interrupted a read.
  constexpr int kEdges = 2 * 9;
  for (int edge = 0; edge < kEdges; ++edge) {
    ASSERT_EQ(bench_.execute("watch " + std::to_string(data + 1) + " 100000000"), "1") << edge;
  }
  bench_.execute("pin " + std::to_string(data) + " high");
  bench_.run_for(kComingUp);
  EXPECT_EQ(bench_.outputs(), kPowerOnValue) << "the settings have not been read";
  EXPECT_EQ(ask("~01OVALVE"), "!01\r");
}

TEST_F(PicoWithEeprom, AModuleWithoutAnEepromWorksWithFactorySettings) {
  const Model& model = *find_model("EX9043D");
  bench_.begin_anew(model, nullptr);
  bench_.execute("absent");
  bench_.power(true);
  bench_.run_for(milliseconds(1000));
  EXPECT_EQ(ask("$01M"), "!019043D\r");
  EXPECT_EQ(ask("~01OVALVE"), "?01\r");
  EXPECT_EQ(bench_.counts().at("timeouts"), 0);
}

// The LED on a Pico W is connected to the radio chip, so the image for a Pico W drives an LED of the module
// instead.
TEST_F(PicoImage, TheStatusLedOfAPicoWUsesAPinThatTheRadioDoesNotUse) {
  constexpr std::uint32_t kLedOfPicoW = 1U << 22;
  constexpr std::uint32_t kRadio = 1U << 23 | 1U << 24 | 1U << 25 | 1U << 29;
  bench_.begin_with(EX9000_BUILD_FOLDER "/pico-w/EX9055D.bin");
  bench_.power(true);
  bench_.run_for(kComingUp);
  EXPECT_EQ(ask("$01M"), "!019055\r");
  EXPECT_EQ(bench_.levels() & (kLedOfPicoW | kRadio), kLedOfPicoW);
  EXPECT_EQ(bench_.counts().at("drives"), 1);
}

}  // namespace
}  // namespace ex9000::pico
