// The composition file of a simulated module: a Device (hal/device.hpp) on the test doubles of hal/doubles.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "hal/device.hpp"
#include "hal/doubles/image_slots.hpp"
#include "hal/doubles/init_switch.hpp"
#include "hal/doubles/inputs.hpp"
#include "hal/doubles/kept_word.hpp"
#include "hal/doubles/memory.hpp"
#include "hal/doubles/one_shot_timer.hpp"
#include "hal/doubles/outputs.hpp"
#include "hal/doubles/serial_line.hpp"
#include "hal/doubles/status_led.hpp"
#include "hal/doubles/tick.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "hal/doubles/watchdog.hpp"
#include "hal/eeprom/two_places.hpp"
#include "sim/virtual_line/wires/module_wire.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

class SimulatedModule final : public Station {
 public:
  /// The supply is off at first. `model`: a row of kModels.
  SimulatedModule(Wires& wires, const Model& model, TimingAt timing_at = LineTiming::at);
  SimulatedModule(const SimulatedModule&) = delete;
  SimulatedModule& operator=(const SimulatedModule&) = delete;

  /// Off interrupts a memory write and clears the firmware's state. The bytes that this write does not
  /// change, the input levels and INIT* stay.
  void power(bool on);
  /// A supply failure: as if switched off, but the switch stays as it is.
  void interrupt_supply(bool interrupted);
  [[nodiscard]] bool powered() const { return mcu_.has_value(); }
  [[nodiscard]] bool switched_on() const { return switched_on_; }
  /// The supply stays on; no effect without it.
  void reset() { restart(ResetReason::ResetPin); }
  /// true: INIT* is tied to GND.
  void set_init(bool asserted);
  /// The board's, from the next start on; 0: none.
  void set_serial_number(std::uint32_t number) { serial_number_ = number; }
  /// How much later than the first module it begins a window of an arbitration.
  void set_skew(VirtualTime skew) { skew_ = skew; }
  [[nodiscard]] bool init_asserted() const { return init_switch_.asserted(); }
  /// `channel` from 0; one that the model lacks does not reach the firmware.
  void set_input(unsigned channel, bool level);
  /// Each pulse changes the level and changes it back, in no virtual time.
  void pulse_input(unsigned channel, std::uint32_t count);
  /// Stops the main loop, by default until the next reset. Interrupts go on.
  void hang(VirtualTime time = kNever);
  /// From now on, an image that an update has brought hangs when it starts.
  void start_bad_images(bool bad) { images_are_bad_ = bad; }
  /// Keeps the driver enabled `by` longer after each reply, through resets and power cycles.
  void release_driver_late(VirtualTime by);
  /// Overrides the rate of the settings; 0: no longer. A reply that has begun keeps its rate.
  void force_rate(std::uint32_t baud);
  /// In which the module receives; a rate of 0: it does not listen.
  [[nodiscard]] SerialMode mode() const { return mcu_ ? wire_.forced(mcu_->line.mode()) : SerialMode{}; }
  /// These two: see ModuleWire.
  void end_reply_delays(std::size_t fault);
  void watch_replies(ModuleWire::Begins begins, ModuleWire::Ends ends) {
    wire_.watch(std::move(begins), std::move(ends));
  }
  /// Writes the `memory_image`, which the module loads at its next start.
  void store(const Settings& settings) { memory_.contents() = memory_image(model_, settings); }
  /// Of the whole memory; blank for factory settings, like a factory-fresh module's (wire.md D8).
  static std::vector<std::uint8_t> memory_image(const Model& model, const Settings& settings);

  /// What happens, for people: `power off`, `input 3 on`, `outputs 0005`, `settings stored`.
  using Event = std::function<void(const std::string& text)>;
  void tell(Event event);

  [[nodiscard]] const Model& model() const { return model_; }
  /// Only while powered.
  [[nodiscard]] const Module& module() const { return mcu_->device.module(); }
  [[nodiscard]] std::uint16_t outputs() const { return outputs_.channels(); }
  /// At the terminals; bit n is channel n.
  [[nodiscard]] std::uint16_t input_levels() const { return inputs_.levels(); }
  [[nodiscard]] bool led_lit() const { return led_.lit(); }
  hal::doubles::Memory& memory() { return memory_; }
  [[nodiscard]] const hal::doubles::Memory& memory() const { return memory_; }
  hal::doubles::ImageSlots& slots() { return slots_; }
  hal::doubles::Outputs& output_pins() { return outputs_; }
  hal::doubles::StatusLed& led() { return led_; }
  /// Starting, waiting for the end of a silence (not of a shared ear's) or of a turn-around time, processing
  /// a request, accessing the memory, replying, or with a late reply that waits or is on the wires.
  [[nodiscard]] bool pending() const;
  /// By the hardware watchdog, since construction.
  [[nodiscard]] std::uint64_t watchdog_resets() const { return watchdog_resets_; }
  /// Until the next reset; only while powered.
  void stop_tick();

  void run() override;
  std::optional<Character> next_byte() override { return wire_.next_byte(); }
  void receive(std::uint8_t byte, ByteStatus status) override;
  [[nodiscard]] std::optional<Hearing> hearing() const override;
  void catch_up(const Heard& missed) override;

 private:
  /// See hal::Device.
  struct Board {
    VirtualClock& clock;
    hal::doubles::SerialLine& line;
    hal::doubles::OneShotTimer& silence_timer;
    hal::doubles::OneShotTimer& wake_timer;
    hal::doubles::Inputs& inputs;
    hal::doubles::Outputs& outputs;
    hal::TwoPlaces<hal::doubles::Memory&> memory;
    hal::doubles::InitSwitch& init_switch;
    hal::doubles::StatusLed& status_led;
    hal::doubles::Watchdog& watchdog;
    hal::doubles::KeptWord& kept_word;
    hal::doubles::ImageSlots& slots;
  };

  /// The parts that lose their state at a reset.
  struct Mcu {
    explicit Mcu(SimulatedModule& module);

    hal::doubles::SerialLine line;
    hal::doubles::OneShotTimer silence_timer;
    hal::doubles::OneShotTimer wake_timer;
    hal::doubles::Tick tick;
    hal::doubles::Watchdog watchdog;
    hal::Device<Board> device;
  };

  void say(const std::string& text) const;
  void say_stores();
  [[nodiscard]] std::string why_outputs_change() const;
  void end_silence();
  void run_line();
  void run_memory();
  void run_timers();
  [[gnu::noinline]] void receive_after_silence(std::uint8_t byte, ByteStatus status);
  [[gnu::noinline]] void work();
  void work_or_wait() {
    if (mcu_->device.has_work()) {
      work();
    } else {
      wait();
    }
  }
  void wait() { run_at(std::min(next_without_silence_, mcu_->silence_timer.next())); }
  /// Calls Wires only if the time changes: on an instant line, most bytes do not change it.
  void run_at(VirtualTime when) {
    if (when != runs_at_) {
      runs_at_ = when;
      end_.run_at(when);
    }
  }
  void settle();
  void follow_supply();
  void start(ResetReason reason);
  void restart(ResetReason reason);
  void stop();
  void turn();
  void edge(unsigned channel, bool level);
  void react();

  VirtualClock& clock_;
  const Model& model_;
  TimingAt timing_at_;
  WireEnd& end_;
  hal::doubles::Memory memory_;
  Event event_;
  std::uint16_t stores_ = 0;  ///< that `run_memory` has seen
  hal::doubles::Inputs inputs_;
  hal::doubles::Outputs outputs_;
  hal::doubles::StatusLed led_;
  hal::doubles::InitSwitch init_switch_;
  hal::doubles::KeptWord kept_word_;
  hal::doubles::ImageSlots slots_;
  bool images_are_bad_ = false;
  VirtualTime driver_late_by_{0};
  std::uint32_t serial_number_ = 0;
  VirtualTime skew_{0};
  bool switched_on_ = false;
  bool supply_interrupted_ = false;
  VirtualTime hangs_until_{0};  ///< 0: the main loop runs
  bool in_dcon_frame_ = false;  ///< perhaps: since the last CR or reply, a byte has arrived
  std::uint64_t watchdog_resets_ = 0;
  SerialMode listens_in_;  ///< the mode that the last call of `WireEnd::listen` has set
  // `receive` uses the members from here on: next to each other, they occupy few cache lines.
  ModuleWire wire_;
  VirtualTime next_without_silence_ = kNever;
  VirtualTime runs_at_ = kNever;  ///< when Wires calls `run`
  std::optional<Mcu> mcu_;
};

}  // namespace ex9000::sim
