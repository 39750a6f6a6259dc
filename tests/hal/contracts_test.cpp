// The compiler checks the requirements of hal/: it rejects a driver that lacks a required function or
// declares it with a wrong signature. refused/ tests the messages of the compiler.
#include <gtest/gtest.h>

#include "hal/board.hpp"
#include "hal/flash.hpp"
#include "hal/i2c_master.hpp"
#include "hal/tick.hpp"
#include "tests/hal/right_board.hpp"

namespace ex9000::hal {
namespace {

// Each type below whose assertion begins with `!` has at least one missing or wrong member.

struct ClockWithoutNowInInterrupt {
  [[nodiscard]] static Time now();
};
struct ClockThatCannotBeConst {
  Time now();
  Time now_in_interrupt();
};
struct ClockOfPlainNumbers {
  [[nodiscard]] static std::uint32_t now();
  [[nodiscard]] static std::uint32_t now_in_interrupt();
};
static_assert(kIsClock<RightClock>);
static_assert(!kIsClock<ClockWithoutNowInInterrupt>);
static_assert(!kIsClock<ClockThatCannotBeConst>);
static_assert(!kIsClock<ClockOfPlainNumbers>);

struct LineOfNarrowRates {
  static void open(std::uint16_t baud, LineFormat format);
  static void send(Bytes bytes);
  [[nodiscard]] static bool sending();
};
struct LineOfOneFormat {
  static void open(std::uint32_t baud);
  static void send(Bytes bytes);
  [[nodiscard]] static bool sending();
};
struct LineThatWritesWhatItSends {
  static void open(std::uint32_t baud, LineFormat format);
  static void send(MutableBytes bytes);
  [[nodiscard]] static bool sending();
};
static_assert(kIsSerialLine<RightLine>);
static_assert(!kIsSerialLine<LineOfNarrowRates>);
static_assert(!kIsSerialLine<LineOfOneFormat>);
static_assert(!kIsSerialLine<LineThatWritesWhatItSends>);

struct TimerThatTakesByReference {
  static void restart(const Duration& after);
};
struct TimerOfPlainNumbers {
  static void restart(std::uint32_t microseconds);
};
struct TimerThatReturnsSomething {
  static bool restart(Duration after);
};
static_assert(kIsOneShotTimer<RightTimer>);
static_assert(kIsOneShotTimer<TimerThatTakesByReference>);
static_assert(!kIsOneShotTimer<TimerOfPlainNumbers>);
static_assert(!kIsOneShotTimer<TimerThatReturnsSomething>);

struct RightTick {
  static void start();
};
struct TickOfAnyPeriod {
  static void start(Duration period);
};
static_assert(kIsTick<RightTick>);
static_assert(!kIsTick<TickOfAnyPeriod>);

struct InputsOfAByte {
  static std::uint8_t start();
};
static_assert(kIsInputs<RightInputs>);
static_assert(!kIsInputs<InputsOfAByte>);

struct OutputsOfAByte {
  static void drive(std::uint8_t channels);
};
struct OutputsOfAWord {
  static void drive(std::uint32_t channels);
};
static_assert(kIsOutputs<RightOutputs>);
static_assert(!kIsOutputs<OutputsOfAByte>);
static_assert(!kIsOutputs<OutputsOfAWord>);

struct MemoryWhosePollReturnsNothing : RightMemory {
  static void poll(Time now);
};
struct MemoryWithExchangedParameters : RightMemory {
  static void start_write(Bytes source, std::uint16_t address, Time now);
};
static_assert(kIsMemory<RightMemory>);
static_assert(!kIsMemory<MemoryWhosePollReturnsNothing>);
static_assert(!kIsMemory<MemoryWithExchangedParameters>);

struct SwitchOfANumber {
  [[nodiscard]] static int asserted();
};
static_assert(kIsInitSwitch<RightSwitch>);
static_assert(!kIsInitSwitch<SwitchOfANumber>);

struct LedOfBrightness {
  static void light(int brightness);
};
static_assert(kIsStatusLed<RightLed>);
static_assert(!kIsStatusLed<LedOfBrightness>);

struct HiddenWatchdog {
 private:
  static void feed();
};
static_assert(kIsWatchdog<RightWatchdog>);
static_assert(!kIsWatchdog<HiddenWatchdog>);

struct RightMaster {
  static void begin(const I2cTransfer& transfer, Time now);
  static bool poll(Time now);
  [[nodiscard]] static bool busy();
  [[nodiscard]] static I2cResult result();
};
struct MasterWithABooleanResult : RightMaster {
  [[nodiscard]] static bool result();
};
static_assert(kIsI2cMaster<RightMaster>);
static_assert(!kIsI2cMaster<MasterWithABooleanResult>);

struct RightFlash {
  static void start_erase(std::uint32_t address);
  static void start_program(std::uint32_t address, Bytes source);
  [[nodiscard]] static bool busy();
  static void suspend();
  static void resume();
  static void read(std::uint32_t address, MutableBytes destination);
};
struct FlashOf64Kilobytes : RightFlash {
  static void read(std::uint16_t address, MutableBytes destination);
};
struct FlashThatWritesWhatItPrograms : RightFlash {
  static void start_program(std::uint32_t address, MutableBytes source);
};
struct FlashThatCannotContinue {
  static void start_erase(std::uint32_t address);
  static void start_program(std::uint32_t address, Bytes source);
  [[nodiscard]] static bool busy();
  static void suspend();
  static void read(std::uint32_t address, MutableBytes destination);
};
struct FlashThatReturnsItsStatus : RightFlash {
  [[nodiscard]] static std::uint8_t busy();
};
static_assert(kIsFlash<RightFlash>);
static_assert(!kIsFlash<FlashOf64Kilobytes>);
static_assert(!kIsFlash<FlashThatWritesWhatItPrograms>);
static_assert(!kIsFlash<FlashThatCannotContinue>);
static_assert(!kIsFlash<FlashThatReturnsItsStatus>);

struct BoardThatRefers {
  RightClock& clock;
  RightLine& line;
  RightTimer& silence_timer;
  RightTimer& wake_timer;
  RightInputs& inputs;
  RightOutputs& outputs;
  RightMemory& memory;
  RightSwitch& init_switch;
  RightLed& status_led;
  RightWatchdog& watchdog;
};
static_assert(is_board<RightBoard>());
static_assert(is_board<BoardThatRefers>());

TEST(Contracts, AreCheckedByTheCompiler) { SUCCEED() << "this test has been compiled"; }

}  // namespace
}  // namespace ex9000::hal
