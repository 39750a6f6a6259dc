// A microcontroller for one driver at a time. Its system clock is 50 MHz, and the clock gates of all
// peripherals except UART1 are open. The test sets the handlers of the interrupts.
#pragma once

#include <functional>
#include <map>
#include <utility>

#include "hal/stellaris/system_control.hpp"
#include "tests/mcu_model/microcontroller.hpp"

namespace ex9000::registers {

class DriverBench {
 public:
  explicit DriverBench(const Chip& chip = kLm3s6965, I2cBehaviour behaviour = {})
      : mcu(chip, timeline, pins, behaviour) {
    using hal::stellaris::SystemControl;
    SystemControl::open({1U << 3U, 1U << 0U | 1U << 12U | 7U << 16U, (1U << chip.ports) - 1U});
    SystemControl::use({chip.crystal_code, 4});
    mcu.on_exception([this](unsigned exception) {
      const auto handler = handlers_.find(exception);
      if (handler == handlers_.end()) {
        throw Fault(exception, "the exception with this number has no handler");
      }
      handler->second();
    });
  }

  /// Enables interrupt `number` and sets its handler.
  void serve(unsigned number, std::function<void()> handler) {
    handlers_[Core::kFirstInterrupt + number] = std::move(handler);
    mcu.write(Core::kBase + Core::kSetEnable, 1U << number);
  }
  void serve_tick(std::function<void()> handler) { handlers_[Core::kTick] = std::move(handler); }

  [[nodiscard]] Instant now() const { return timeline.now(); }

  Timeline timeline;
  Pins pins;
  Microcontroller mcu;

 private:
  std::map<unsigned, std::function<void()>> handlers_;
};

constexpr unsigned kUart0Interrupt = 5;
constexpr unsigned kI2cInterrupt = 8;
constexpr unsigned kTimer0Interrupt = 19;
constexpr unsigned kTimer1Interrupt = 21;
constexpr unsigned kTimer2Interrupt = 23;

}  // namespace ex9000::registers
