// Tests a whole module that keeps its settings in a flash, in virtual time. The module replies in time while
// it erases sectors, starts in time after a reset during an erase, and erases all free sectors in advance
// while it is idle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <vector>

#include "firmware/line/crc16.hpp"
#include "firmware/line/timing.hpp"
#include "hal/device.hpp"
#include "hal/tick.hpp"
#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000 {
namespace {

using hal::flash::FlashChip;
using hal::flash::FlashPort;
using hal::flash::kPlacesOfASector;
using hal::flash::OnFlash;

constexpr std::uint64_t kForever = UINT64_MAX;
constexpr std::uint32_t kBaud = 115'200;
constexpr std::uint8_t kBaudCode = 0x0A;
constexpr std::uint64_t kReplyLimit = 200'000;  ///< us; wire.md section 7

/// A board (hal/device.hpp) with a flash, timers and a line. Its clock returns the time of the flash chip.
/// Its inputs, outputs, switch, LED and watchdog do nothing.
struct FlashBoard {
  struct Clock {
    const FlashChip* chip;
    [[nodiscard]] Time now() const { return chip->time(); }
    [[nodiscard]] Time now_in_interrupt() const { return chip->time(); }
  };
  struct Timer {
    const FlashChip* chip;
    std::uint64_t fires = kForever;
    void restart(Duration after) { fires = chip->now + after.microseconds(); }
  };
  struct Line {
    const FlashChip* chip;
    std::uint64_t begins = 0;
    std::uint64_t ends = kForever;
    std::vector<std::uint8_t> reply{};
    static LineTiming timing(std::uint32_t baud, LineFormat format) { return LineTiming::at(baud, format); }
    static void open(std::uint32_t baud, LineFormat /*format*/) { EXPECT_EQ(baud, kBaud); }
    void send(Bytes bytes) {
      reply.assign(bytes.begin(), bytes.end());
      begins = chip->now;
      ends = begins + bytes.size * 10'000'000U / kBaud + 1;
    }
    [[nodiscard]] bool sending() const { return ends != kForever; }
  };
  struct NoInputs {
    static std::uint16_t start() { return 0; }
  };
  struct NoOutputs {
    static void drive(std::uint16_t /*channels*/) {}
  };
  struct NoSwitch {
    [[nodiscard]] static bool asserted() { return false; }
  };
  struct NoLed {
    static void light(bool /*on*/) {}
  };
  struct NoWatchdog {
    static void feed() {}
  };

  explicit FlashBoard(FlashChip& chip) : clock{&chip}, line{&chip}, silence_timer{&chip}, wake_timer{&chip} {
    memory.flash().chip = &chip;
  }

  Clock clock;
  Line line;
  Timer silence_timer;
  Timer wake_timer;
  NoInputs inputs;
  NoOutputs outputs;
  hal::flash::Log memory;
  NoSwitch init_switch;
  NoLed status_led;
  NoWatchdog watchdog;
};

class ModuleOnFlash {
 public:
  using Frame = std::vector<std::uint8_t>;

  explicit ModuleOnFlash(FlashChip& chip) : chip_(chip), device_(the_model(), FlashBoard(chip)) {
    device_.start(ResetReason::PowerOn);
    const std::uint64_t began = chip.now;
    while (!device_.module().listening()) {
      run(1'000);
    }
    EXPECT_LE(chip.now - began, 100'000U) << "a module is ready to receive within 100 ms of a reset";
    run(5'000);
  }

  void run(std::uint64_t microseconds) { run_until(chip_.now + microseconds); }

  /// Sends `request` and its CRC. Returns the reply without its CRC; if there is no reply, fails the test and
  /// returns an empty frame.
  Frame ask(Frame request) {
    constexpr std::uint64_t kCharacter = 11'000'000 / kBaud;
    const Crc16 crc = crc16({request.data(), request.size()});
    request.push_back(crc.low_byte());
    request.push_back(crc.high_byte());
    for (const std::uint8_t byte : request) {
      run(kCharacter);
      device_.on_receive(byte, ByteStatus::Good);
    }
    const std::uint64_t sent = chip_.now;
    FlashBoard::Line& line = device_.board().line;
    line.reply.clear();
    while ((line.reply.empty() || line.sending()) && chip_.now - sent < 2 * kReplyLimit) {
      run_until(std::min(next_event(), chip_.now + 1'000));
    }
    if (line.reply.empty()) {
      ADD_FAILURE() << "no reply";
      return {};
    }
    latency = line.begins - sent;
    longest = std::max(longest, latency);
    return {line.reply.begin(), line.reply.end() - 2};
  }
  /// Sends a request to store a timeout of the host watchdog. `number` determines this timeout. Returns
  /// whether the module replied that the timeout is stored.
  bool store(unsigned number) {
    const auto timeout = static_cast<std::uint8_t>(number % 250 + 1);
    const Frame request{1, 0x06, 0x01, 0xE8, 0x00, timeout};
    return ask(request) == request;
  }
  [[nodiscard]] unsigned timeout() { return ask({1, 0x03, 0x01, 0xE8, 0, 1}).at(4); }

  std::uint64_t latency = 0;  ///< us from the end of the last request to the start of its reply
  std::uint64_t longest = 0;  ///< the greatest `latency` so far

 private:
  [[nodiscard]] std::uint64_t next_event() {
    const FlashBoard& board = device_.board();
    return std::min(std::min(board.silence_timer.fires, board.wake_timer.fires),
                    std::min(board.line.ends, next_tick_));
  }
  void run_until(std::uint64_t end) {
    for (std::uint64_t next = next_event(); next <= end; next = next_event()) {
      chip_.run(next > chip_.now ? next - chip_.now : 0);
      happen();
    }
    if (chip_.now < end) {
      chip_.run(end - chip_.now);
    }
  }
  void happen() {
    FlashBoard& board = device_.board();
    if (board.line.ends <= chip_.now) {
      board.line.ends = kForever;
      device_.on_sent();
    }
    if (board.silence_timer.fires <= chip_.now) {
      board.silence_timer.fires = kForever;
      device_.on_silence();
    }
    if (board.wake_timer.fires <= chip_.now) {
      board.wake_timer.fires = kForever;
      device_.on_wake_timer();
    }
    if (next_tick_ <= chip_.now) {
      next_tick_ += hal::kTickPeriod.microseconds();
      device_.on_tick();
    }
    main_loop();
  }
  void main_loop() {
    constexpr std::uint64_t kTurn = 10;  // us
    constexpr unsigned kMostTurns = 1'000;
    unsigned turns = 0;
    while (device_.turn() || device_.has_work()) {
      chip_.run(kTurn);
      ASSERT_LT(++turns, kMostTurns) << "the main loop still has work after 1000 turns";
    }
  }

  FlashChip& chip_;
  hal::Device<FlashBoard> device_;
  std::uint64_t next_tick_ = 0;
};

/// Returns a flash that contains settings with 115200 baud. All its free sectors are erased.
FlashChip flash_at_115200() {
  FlashChip chip = hal::flash::settled();
  Settings settings = factory();
  settings.baud_code = kBaudCode;
  EXPECT_TRUE(OnFlash(chip).save(settings));
  return chip;
}

TEST(FlashDevice, AnIdleModuleErasesAllFreeSectorsInAdvance) {
  FlashChip chip = flash_at_115200();
  chip.cells.assign(chip.cells.size(), 0);  // no sector is erased or contains settings
  FlashChip used = flash_at_115200();
  std::copy_n(used.cells.begin(), FlashChip::kSector, chip.cells.begin());
  const auto before = chip.erases;
  ModuleOnFlash module(chip);
  module.run(13 * (45'000 + 2 * hal::kTickPeriod.microseconds()));
  for (unsigned sector = 1; sector < hal::flash::kSectors; ++sector) {
    EXPECT_EQ(chip.erases[sector], before[sector] + 1) << sector;
  }
  EXPECT_EQ(chip.erases[0], before[0]) << "this sector holds the settings";
  EXPECT_TRUE(module.store(7));
  EXPECT_LE(module.latency, 10'000U);
}

TEST(FlashDevice, StoresWithShortPausesSucceedInTimeWithErasesOf400Milliseconds) {
  FlashChip chip = flash_at_115200();
  chip.times = FlashChip::kLongest;
  ModuleOnFlash module(chip);
  for (unsigned i = 0; i < 300; ++i) {
    ASSERT_TRUE(module.store(i)) << i;
    module.run(500'000 - i % 50 * 7'333);
  }
  EXPECT_LE(module.longest, kReplyLimit);
  std::printf("stores with pauses of 140 to 500 ms, erase 400 ms: slowest reply after %.1f ms\n",
              static_cast<double>(module.longest) / 1e3);
}

TEST(FlashDevice, StoresWithoutPausesSucceedInTimeWithErasesOf45Milliseconds) {
  constexpr unsigned kStores = 5'000;
  FlashChip chip = flash_at_115200();
  ModuleOnFlash module(chip);
  const std::uint64_t began = chip.now;
  for (unsigned i = 0; i < kStores; ++i) {
    ASSERT_TRUE(module.store(i)) << i;
  }
  EXPECT_LE(module.longest, kReplyLimit);
  EXPECT_GT(chip.suspensions, kStores / 10);
  std::printf("%u stores without pauses, one every %.1f ms, erase 45 ms: slowest reply after %.1f ms\n",
              kStores, static_cast<double>(chip.now - began) / 1e3 / kStores,
              static_cast<double>(module.longest) / 1e3);
}

TEST(FlashDevice, StoresWithoutPausesSucceedOrAreRefusedInTimeWithErasesOf400Milliseconds) {
  constexpr unsigned kStores = 5'000;
  FlashChip chip = flash_at_115200();
  chip.times = FlashChip::kLongest;
  ModuleOnFlash module(chip);
  const std::uint64_t began = chip.now;
  unsigned refused = 0;
  unsigned expected = 0;
  for (unsigned i = 0; i < kStores; ++i) {
    if (module.store(i)) {
      expected = i % 250 + 1;
    } else {
      ++refused;
    }
  }
  EXPECT_LE(module.longest, kReplyLimit);
  std::printf(
      "%u stores without pauses, one every %.1f ms, erase 400 ms: slowest reply after %.1f ms, %u refused\n",
      kStores, static_cast<double>(chip.now - began) / 1e3 / kStores,
      static_cast<double>(module.longest) / 1e3, refused);
  EXPECT_EQ(module.timeout(), expected);
  chip.power_off({});
  EXPECT_EQ(ModuleOnFlash(chip).timeout(), expected);
}

TEST(FlashDevice, AModuleStartsInTimeWithItsSettingsAfterAResetDuringAnErase) {
  FlashChip chip = flash_at_115200();
  chip.times = FlashChip::kLongest;
  ModuleOnFlash before(chip);
  for (unsigned i = 0; i < 130; ++i) {
    ASSERT_TRUE(before.store(i));
  }
  ASSERT_EQ(chip.operation(), FlashChip::Operation::Erase);
  ModuleOnFlash after(chip);
  EXPECT_EQ(after.timeout(), 130U);
  EXPECT_TRUE(after.store(3));
}

}  // namespace
}  // namespace ex9000
