// An image from reset to the main loop: the drivers on the pins of `board.hpp`, the module on the drivers,
// and the interrupts. Included once, by the main.cpp of a board.
#pragma once

#include <array>
#include <cstdint>

#include "boards/start_up.hpp"
#include "firmware/model/built.hpp"
#include "hal/at24c/at24c.hpp"
#include "hal/device.hpp"
#include "hal/stellaris/i2c.hpp"
#include "hal/stellaris/inputs.hpp"
#include "hal/stellaris/interrupts.hpp"
#include "hal/stellaris/one_shot_timer.hpp"
#include "hal/stellaris/outputs.hpp"
#include "hal/stellaris/switches.hpp"
#include "hal/stellaris/system_control.hpp"
#include "hal/stellaris/system_timer.hpp"
#include "hal/stellaris/uart.hpp"
#include "hal/stellaris/watchdog.hpp"

// NOLINTBEGIN(cert-dcl59-cpp,google-build-namespaces,misc-definitions-in-headers): included once
namespace ex9000::board {
namespace {

using namespace hal::stellaris;

constexpr std::uint32_t kHertz = kClock.frequency();
constexpr std::uint32_t kMegahertz = kHertz / 1'000'000;

#ifdef EX9000_IMAGES
static_assert(kModels.size() == EX9000_IMAGES,
              "a row of the model table gets no image: boards/CMakeLists.txt reads rows that begin with "
              "{\"EX9..., inputs, outputs");
#endif

template <class Groups>
constexpr unsigned pins_in(const Groups& groups) {
  unsigned pins = 0;
  for (const PinGroup& group : groups) {
    pins += group.count;
  }
  return pins;
}
static_assert(kOnlyModel.outputs <= pins_in(kOutputs), "this board has too few output pins for the model");
static_assert(kOnlyModel.inputs <= pins_in(kInputs), "this board has too few input pins for the model");

using Clock = SystemTimer<kMegahertz>;
using SilenceTimer = OneShotTimer<0, kMegahertz>;
using LineEndTimer = OneShotTimer<1, kMegahertz>;
using WakeTimer = OneShotTimer<2, kMegahertz>;
using Line = Uart<kUart, kHertz, kDriverEnable, LineEndTimer>;
using Eeprom = hal::At24c<I2c<kFamily, kHertz>>;
using Watchdog = HardwareWatchdog<kMegahertz>;

/// See hal::Board.
struct Board {
  Clock clock;
  Line line;
  SilenceTimer silence_timer;
  WakeTimer wake_timer;
  InputPins<kInputs, kOnlyModel.inputs, kInputsActiveHigh> inputs;
  OutputPins<kOutputs, kOnlyModel.outputs, kOutputsActiveHigh> outputs;
  Eeprom memory;
  InitPin<kInitSwitch> init_switch;
  LedPin<kStatusLed> status_led;
  Watchdog watchdog;
};

#ifdef EX9000_STRICT_GAPS
constexpr TimingAt kTimingAt = LineTiming::strictly_told_in_the_stop_bit;
#else
constexpr TimingAt kTimingAt = LineTiming::told_in_the_stop_bit;
#endif

hal::Device<Board> device(kOnlyModel, kTimingAt);
Board& board = device.board();

// --- interrupts: none interrupts another ---

void on_system_tick() {
  board.clock.count_in_interrupt();
  device.on_tick();
}

void on_line() {
  board.line.on_interrupt([](std::uint8_t byte, ByteStatus status) { device.on_receive(byte, status); });
}

void on_silence_timer() {
  if (SilenceTimer::ran_out()) {
    device.on_silence();
  }
}

void on_line_end_timer() {
  if (LineEndTimer::ran_out()) {
    if (board.line.on_end_timer()) {
      device.on_sent();
    }
  }
}

void on_wake_timer() {
  if (WakeTimer::ran_out()) {
    device.on_wake_timer();
  }
}

void on_i2c() {
  board.memory.master().on_interrupt();
  device.on_memory();
}

struct DeliverEdge {
  void operator()(unsigned channel, bool level) const { device.on_edge(channel, level); }
};

template <Port port>
void on_edges() {
  board.inputs.take_edges<port>(DeliverEdge());
}

/// Null where this model has no input on the port.
template <Port port>
constexpr start_up::Handler handler_of_edges() {
  if constexpr (decltype(board.inputs)::on(port)) {
    return on_edges<port>;
  }
  return nullptr;
}

constexpr Interrupt kLineInterrupt = kUart == 0 ? Interrupt::Uart0 : Interrupt::Uart1;

struct Served {
  Interrupt number;
  start_up::Handler handler;  ///< null: not by this image
};
constexpr auto kServed = table<Served>({
    {kLineInterrupt, on_line},
    {Interrupt::Timer0A, on_silence_timer},
    {Interrupt::Timer1A, on_line_end_timer},
    {Interrupt::Timer2A, on_wake_timer},
    {Interrupt::GpioA, handler_of_edges<Port::A>()},
    {Interrupt::GpioB, handler_of_edges<Port::B>()},
    {Interrupt::GpioC, handler_of_edges<Port::C>()},
    {Interrupt::GpioD, handler_of_edges<Port::D>()},
    {Interrupt::GpioE, handler_of_edges<Port::E>()},
    {Interrupt::I2c0, on_i2c},
});

constexpr std::uint32_t served_numbers() {
  std::uint32_t numbers = 0;
  for (const Served& served : kServed) {
    if (served.handler != nullptr) {
      numbers |= 1U << static_cast<unsigned>(served.number);
    }
  }
  return numbers;
}

constexpr unsigned kInterrupts = 24;
using Vectors = start_up::VectorTable<kInterrupts>;

constexpr Vectors make_vectors() {
  constexpr start_up::Handler kFault = start_up::fault_handler;
  Vectors vectors{&start_up::stack_top,
                  start_up::reset_handler,
                  kFault,
                  kFault,
                  kFault,
                  kFault,
                  kFault,
                  {kFault, kFault, kFault, kFault},
                  kFault,
                  kFault,
                  kFault,
                  kFault,
                  on_system_tick,
                  {}};
  for (start_up::Handler& handler : vectors.interrupt) {
    handler = kFault;
  }
  for (const Served& served : kServed) {
    if (served.handler != nullptr) {
      vectors.interrupt[static_cast<unsigned>(served.number)] = served.handler;
    }
  }
  return vectors;
}

__attribute__((section(".vectors"), used)) constexpr Vectors kVectors = make_vectors();

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
  for (const Pin pin : {kDriverEnable, kInitSwitch, kStatusLed}) {
    add(pin.port);
  }
  add(Port::B);  // I2C0
  return ports;
}

constexpr ClockGates kClockGates{
    clock_gate::kWatchdog,
    (kUart == 0 ? clock_gate::kUart0 : clock_gate::kUart1) | clock_gate::kI2c0 | clock_gate::kTimer0 |
        clock_gate::kTimer1 | clock_gate::kTimer2,
    ports_of_the_module(),
};

/// The watchdog first, so that nothing behind it can hang for ever; then the outputs, which float until here.
void start() {
  SystemControl::open(kClockGates);
  Watchdog::start();
  board.outputs.start();
  board.line.start();
  board.init_switch.start();
  board.status_led.start();
  SystemControl::use(kClock);
  Gpio(kUartPins.port).make_peripheral<kFamily, kUartPins.mask(), kUartFunction>();
  board.memory.master().start();
  SilenceTimer::start();
  LineEndTimer::start();
  WakeTimer::start();
  board.clock.start();
  device.start();
  Interrupts::enable(served_numbers(), kLineInterrupt);
}

}  // namespace
}  // namespace ex9000::board

int main() {
  using namespace ex9000::board;
  start();
  for (;;) {
    while (device.turn()) {
    }
    Interrupts::sleep_until([] { return device.news(); });
  }
}
// NOLINTEND(cert-dcl59-cpp,google-build-namespaces,misc-definitions-in-headers)
