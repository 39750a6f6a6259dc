// The composition of an image for a board of the Stellaris family (LM3S and TM4C): connects the drivers to
// the pins of the board, the module to the drivers, and the interrupts to their handlers. The folder of the
// board is in the include path.
#include <cstdint>
#include <type_traits>

#include "board.hpp"
#include "boards/cortex_m/start_up.hpp"
#include "boards/image.hpp"
#include "boards/runtime.hpp"
#include "firmware/model/built.hpp"
#include "hal/at24c/at24c.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/cortex_m/system_timer.hpp"
#include "hal/device.hpp"
#include "hal/eeprom/two_places.hpp"
#include "hal/pins/single_pins.hpp"
#include "hal/stellaris/i2c.hpp"
#include "hal/stellaris/inputs.hpp"
#include "hal/stellaris/interrupts.hpp"
#include "hal/stellaris/kept_word.hpp"
#include "hal/stellaris/one_shot_timer.hpp"
#include "hal/stellaris/outputs.hpp"
#include "hal/stellaris/system_control.hpp"
#include "hal/stellaris/uart.hpp"
#include "hal/stellaris/watchdog.hpp"

namespace ex9000::board {
namespace {

using namespace hal::cortex_m;
using namespace hal::stellaris;

constexpr std::uint32_t kHertz = kClock.frequency();
constexpr std::uint32_t kMegahertz = kHertz / 1'000'000;

using Clock = SystemTimer<kMegahertz>;
using SilenceTimer = OneShotTimer<0, kMegahertz>;
using LineEndTimer = OneShotTimer<1, kMegahertz>;
using WakeTimer = OneShotTimer<2, kMegahertz>;
using Line = Uart<kUart, kHertz, kDriverEnable, LineEndTimer>;
using Memory = hal::TwoPlaces<hal::At24c<I2c<kFamily, kHertz>>>;
using Watchdog = HardwareWatchdog<kMegahertz>;

__attribute__((section(".kept"))) WrittenByMainLoop<std::uint32_t> kept;

/// See hal::Device.
struct Board {
  Clock clock;
  Line line;
  SilenceTimer silence_timer;
  WakeTimer wake_timer;
  InputPins<kInputs, kOnlyModel.inputs, kInputsActiveHigh> inputs;
  OutputPins<kOutputs, kOnlyModel.outputs, kOutputsActiveHigh> outputs;
  Memory memory;
  hal::InitPin<kInitSwitch> init_switch;
  hal::LedPin<kStatusLed> status_led;
  Watchdog watchdog;
  KeptWord<kept> kept_word;
};

hal::Device<Board> device(kOnlyModel);
Board& board = device.board();
using Run = Runtime<device, Clock, SilenceTimer, LineEndTimer, WakeTimer>;

// --- interrupts; all have the same preemption priority, so an interrupt never interrupts another one ---

void on_system_tick() {
  board.clock.count_in_interrupt();
  device.on_tick();
}

void on_i2c() {
  board.memory.eeprom().master().on_interrupt();
  device.on_memory();
}

struct DeliverEdge {
  void operator()(unsigned channel, bool level) const { device.on_edge(channel, level); }
};

template <Port port>
void on_edges() {
  board.inputs.take_edges<port>(DeliverEdge());
}

/// Returns the handler of the port's edge interrupt, or null if this model has no input on the port.
template <Port port>
constexpr start_up::Handler handler_of_edges() {
  if constexpr (decltype(board.inputs)::on(port)) {
    return on_edges<port>;
  }
  return nullptr;
}

constexpr Interrupt kLineInterrupt = kUart == 0 ? Interrupt::Uart0 : Interrupt::Uart1;

constexpr start_up::Served served(Interrupt number, start_up::Handler handler) {
  return {static_cast<unsigned>(number), handler};
}
constexpr start_up::Served kServed[] = {
    served(kLineInterrupt, Run::on_line),
    served(Interrupt::Timer0A, Run::on_silence_timer),
    served(Interrupt::Timer1A, Run::on_line_end_timer),
    served(Interrupt::Timer2A, Run::on_wake_timer),
    served(Interrupt::GpioA, handler_of_edges<Port::A>()),
    served(Interrupt::GpioB, handler_of_edges<Port::B>()),
    served(Interrupt::GpioC, handler_of_edges<Port::C>()),
    served(Interrupt::GpioD, handler_of_edges<Port::D>()),
    served(Interrupt::GpioE, handler_of_edges<Port::E>()),
    served(Interrupt::GpioF, handler_of_edges<Port::F>()),
    served(Interrupt::GpioG, handler_of_edges<Port::G>()),
    served(Interrupt::I2c0, on_i2c),
};

constexpr unsigned kInterrupts = 32;
__attribute__((section(".vectors"), used)) constexpr auto kVectors =
    start_up::vectors<kInterrupts>(on_system_tick, kServed);

constexpr std::uint32_t ports_of_the_module() {
  std::uint32_t ports = 0;
  const auto add = [&ports](Port port) { ports |= 1U << static_cast<unsigned>(port); };
  for (const PinGroup& group : kOutputs) {
    add(group.port);
  }
  for (const PinGroup& group : kInputs) {
    add(group.port);
  }
  add(kUartPins.port);
  const auto add_pin = [add](auto pin) {
    if constexpr (!std::is_same_v<decltype(pin), hal::NoPin>) {
      add(pin.port);
    }
  };
  add_pin(kDriverEnable);
  add_pin(kInitSwitch);
  add_pin(kStatusLed);
  add(Port::B);  // I2C0
  return ports;
}

constexpr ClockGates kClockGates{
    clock_gate::kWatchdog,
    (kUart == 0 ? clock_gate::kUart0 : clock_gate::kUart1) | clock_gate::kI2c0 | clock_gate::kTimer0 |
        clock_gate::kTimer1 | clock_gate::kTimer2,
    ports_of_the_module(),
};

/// For the order, see Runtime.
void start() {
  SystemControl::open(kClockGates);
  Watchdog::start();
  const ResetReason reason = SystemControl::take_reset_reason();
  Run::start_pins();
  SystemControl::use(kClock);
  Gpio(kUartPins.port).make_peripheral<kFamily, kUartPins.mask(), kUartFunction>();
  board.memory.eeprom().master().start();
  Run::start_module(reason);
  Interrupts::enable(start_up::numbers_of(kServed), static_cast<std::uint32_t>(kLineInterrupt));
}

}  // namespace
}  // namespace ex9000::board

int main() {
  using namespace ex9000::board;
  start();
  Run::run_main_loop();
}
