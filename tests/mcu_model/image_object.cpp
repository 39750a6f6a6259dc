// Source of the shared object for a Stellaris board and a model: the unchanged composition and the
// description of the image. The include path and EX9000_MODEL select the board and the model. The image's
// `main` is renamed because the test program has its own.
#define main main_of_the_image
#include "boards/stellaris/composition.cpp"
#undef main

#include <array>
#include <new>

#include "tests/mcu_model/image.hpp"

namespace ex9000::start_up {

// On a board, boards/cortex_m/start_up.cpp and the linker script provide these.
extern "C" {
std::uint32_t stack_top[1] = {};  // NOLINT: the name is the linker script's
void reset_handler() { fault_handler(); }
void fault_handler() { hal::cortex_m::Interrupts::reset(); }
}

}  // namespace ex9000::start_up

namespace ex9000::board {
namespace {

using registers::Image;
using registers::PinPlace;

constexpr PinPlace place(Port port, unsigned pin) {
  return {static_cast<char>('A' + static_cast<int>(port)), static_cast<std::uint8_t>(pin)};
}
constexpr PinPlace place(Pin pin) { return place(pin.port, pin.number); }

template <std::size_t size, class Groups>
constexpr std::array<PinPlace, size> places(const Groups& groups) {
  std::array<PinPlace, size> result{};
  std::size_t channel = 0;
  for (const PinGroup& group : groups) {
    for (unsigned i = 0; i < group.count && channel < size; ++i) {
      result[channel++] = place(group.port, group.first_pin + i);
    }
  }
  return result;
}

void clear() { new (&device) hal::Device<Board>(kOnlyModel); }

void serve(unsigned exception) {
  constexpr unsigned kTick = 15;
  const start_up::Handler handler =
      exception == kTick ? kVectors.system_tick : kVectors.interrupt[exception - kTick - 1];
  handler();
}

}  // namespace

extern "C" __attribute__((visibility("default"))) const Image ex9000_image;
extern "C" const Image ex9000_image{EX9000_MODEL,
                                    kFamily == hal::stellaris::Family::Tm4c,
                                    kOnlyModel.inputs,
                                    kOnlyModel.outputs,
                                    places<16>(kOutputs),
                                    places<8>(kInputs),
                                    place(kDriverEnable),
                                    place(kInitSwitch),
                                    place(kStatusLed),
                                    kUart,
                                    place(kUartPins.port, kUartPins.first_pin),
                                    place(kUartPins.port, kUartPins.first_pin + 1U),
                                    clear,
                                    main_of_the_image,
                                    serve};

}  // namespace ex9000::board
