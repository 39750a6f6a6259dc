// The composition of an image for a board with an RP2040: connects the drivers to the pins of the board, the
// module to the drivers, and the interrupts to their handlers. The folder of the board is in the include
// path.
#include <array>
#include <cstdint>

#include "board.hpp"
#include "boards/cortex_m/start_up.hpp"
#include "boards/image.hpp"
#include "boards/rp2040/memory.hpp"
#include "boards/rp2040/slot_head.hpp"
#include "boards/runtime.hpp"
#include "firmware/line/crc16.hpp"
#include "firmware/model/built.hpp"
#include "firmware/settings/settings.hpp"
#include "hal/at24c/at24c.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/cortex_m/system_tick.hpp"
#include "hal/device.hpp"
#include "hal/eeprom/two_places.hpp"
#include "hal/flash/image_slots.hpp"
#include "hal/flash/record_log.hpp"
#include "hal/pins/single_pins.hpp"
#include "hal/pl011/uart.hpp"
#include "hal/rp2040/clocks.hpp"
#include "hal/rp2040/flash.hpp"
#include "hal/rp2040/i2c.hpp"
#include "hal/rp2040/inputs.hpp"
#include "hal/rp2040/interrupts.hpp"
#include "hal/rp2040/kept_word.hpp"
#include "hal/rp2040/outputs.hpp"
#include "hal/rp2040/resets.hpp"
#include "hal/rp2040/started_slot.hpp"
#include "hal/rp2040/timer.hpp"
#include "hal/rp2040/watchdog.hpp"

namespace ex9000::board {
namespace {

using namespace hal::cortex_m;
using namespace hal::rp2040;

constexpr std::uint32_t kHertz = kClock.frequency();
constexpr std::uint32_t kMegahertz = 1'000'000;
constexpr std::uint32_t kUart0 = 0x4003'4000;

using Tick = SystemTick<kHertz / kMegahertz>;
using SilenceTimer = OneShotTimer<0>;
using LineEndTimer = OneShotTimer<1>;
using WakeTimer = OneShotTimer<2>;
constexpr Pin kReceive{static_cast<std::uint8_t>(kUartPins.first_pin + 1U)};
using Line = hal::pl011::Uart<kUart0, kHertz, hal::Transceiver<kDriverEnable, kReceive>, LineEndTimer>;
using Watchdog = HardwareWatchdog<kClock.crystal / kMegahertz>;

/// The memory that stores the settings: its driver, the functions that start the driver and handle its
/// interrupt, and the log with which the image slots share the flash.
template <Memory memory>
struct MemoryOnBoard;
template <>
struct MemoryOnBoard<Memory::Flash> {
  using Driver = hal::flash::RecordLog<Flash, kSettingsInFlash>;
  using Log = Driver;
  static constexpr Log& log(Driver& driver) { return driver; }
  static void start(Driver& driver) { driver.flash().start(); }
  static void on_interrupt(Driver& /*driver*/) {}
};
template <>
struct MemoryOnBoard<Memory::Eeprom> {
  using Driver = hal::TwoPlaces<hal::At24c<I2c<kI2cPins, kHertz>>>;
  using Log = hal::flash::NoLog<Flash>;
  static inline Log no_log;
  static constexpr Log& log(Driver& /*driver*/) { return no_log; }
  static void start(Driver& driver) {
    driver.eeprom().master().start();
    Flash::start();
  }
  static void on_interrupt(Driver& driver) { driver.eeprom().master().on_interrupt(); }
};
using Settings = MemoryOnBoard<kMemory>;
constexpr bool kUsesI2c = kMemory == Memory::Eeprom;

static_assert(kSlotsInFlash + update::kSlots * update::kSlotSize <= kSettingsInFlash);
using ImageSlots = hal::flash::ImageSlots<Settings::Log, kSlotsInFlash>;

/// See hal::Device.
struct Board {
  Clock clock;
  Line line;
  SilenceTimer silence_timer;
  WakeTimer wake_timer;
  InputPins<kInputs, kOnlyModel.inputs, kInputsActiveHigh> inputs;
  OutputPins<kOutputs, kOnlyModel.outputs, kOutputsActiveHigh> outputs;
  Settings::Driver memory;
  ImageSlots slots{Settings::log(memory)};
  hal::InitPin<kInitSwitch> init_switch;
  hal::LedPin<kStatusLed> status_led;
  Watchdog watchdog;
  KeptWord kept_word;
};

hal::Device<Board> device(kOnlyModel);
Board& board = device.board();
using Run = Runtime<device, Tick, SilenceTimer, LineEndTimer, WakeTimer>;

// --- interrupts; all have the same priority, so an interrupt never interrupts another one ---

void on_system_tick() { device.on_tick(); }

void on_memory() {
  Settings::on_interrupt(board.memory);
  device.on_memory();
}

void on_edges() {
  board.inputs.take_edges([](unsigned channel, bool level) { device.on_edge(channel, level); });
}

constexpr start_up::Served served(Interrupt number, start_up::Handler handler) {
  return {static_cast<unsigned>(number), handler};
}
constexpr start_up::Served kServed[] = {
    served(Interrupt::Timer0, Run::on_silence_timer),
    served(Interrupt::Timer1, Run::on_line_end_timer),
    served(Interrupt::Timer2, Run::on_wake_timer),
    served(Interrupt::Pins, decltype(board.inputs)::any() ? on_edges : nullptr),
    served(Interrupt::Uart0, Run::on_line),
    served(Interrupt::I2c0, kUsesI2c ? on_memory : nullptr),
};

constexpr unsigned kInterrupts = 26;
__attribute__((section(".vectors"), used)) constexpr auto kVectors =
    start_up::vectors<kInterrupts>(on_system_tick, kServed);

std::uint32_t serial_number() {
  const std::array<std::uint8_t, 8> id = Flash::unique_id();
  return serial_number_of(static_cast<std::uint16_t>(crc16({id.data(), id.size()}).value()));
}

/// For the order, see Runtime.
void start() {
  const ResetReason reason = Watchdog::reset_reason();
  Watchdog::start();
  Resets::restart_second_core();
  Resets::restart(Block::Pins | Block::Pads | Block::Timer);
  Run::start_pins();
  Clocks::use<kClock>();
  // This follows the clocks, because a UART without a clock would stay in reset.
  Resets::restart(kUsesI2c ? Block::Uart0 | Block::I2c0 : 0U | Block::Uart0);
  Gpio::make_peripheral(kUartPins.mask(), Function::Uart);
  const std::uint32_t number = serial_number();
  board.slots.begin(StartedSlot::load(), kBoardCode);  // the flash is open since `unique_id`
  Settings::start(board.memory);
  Run::start_module(reason, number);
  Interrupts::enable(start_up::numbers_of(kServed));
}

}  // namespace
}  // namespace ex9000::board

int main() {
  using namespace ex9000::board;
  start();
  Run::run_main_loop();
}
