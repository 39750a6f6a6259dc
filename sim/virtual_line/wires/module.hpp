// A simulated module: a Device (hal/device.hpp) whose peripherals are the test doubles in hal/doubles. This
// file is the composition file of the simulated module.
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
#include "hal/doubles/init_switch.hpp"
#include "hal/doubles/inputs.hpp"
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

/// One module on a wires. Its supply is off at first.
class SimulatedModule final : public Station {
 public:
  /// Attaches itself to `wires`. `model` is a row of kModels; `timing_at`: returns the times of the line.
  SimulatedModule(Wires& wires, const Model& model, TimingAt timing_at = LineTiming::at);
  SimulatedModule(const SimulatedModule&) = delete;
  SimulatedModule& operator=(const SimulatedModule&) = delete;

  // --- actions from outside ---

  /// Switches the supply on or off. Switching off interrupts a memory write that is in progress, and clears
  /// the state of the firmware. The memory keeps all bytes that this write does not change. The input levels
  /// and INIT* stay the same.
  void power(bool on);
  /// Starts or ends a supply failure. A failure has the same effects as switching off, but does not change
  /// the switch of the supply.
  void interrupt_supply(bool interrupted);
  [[nodiscard]] bool powered() const { return mcu_.has_value(); }
  /// Returns whether the switch of the supply is on.
  [[nodiscard]] bool switched_on() const { return switched_on_; }
  /// Resets the module without loss of power. Has no effect without power.
  void reset() { restart(ResetReason::ResetPin); }
  /// Connects INIT* to GND or releases it.
  void set_init(bool asserted);
  [[nodiscard]] bool init_asserted() const { return init_switch_.asserted(); }
  /// Sets the level of an input channel, counted from 0. The level of a channel that the model lacks has no
  /// effect on the firmware.
  void set_input(unsigned channel, bool level);
  /// Applies `count` pulses to an input channel, counted from 0. Each pulse changes the level and changes it
  /// back. The pulses take no virtual time.
  void pulse_input(unsigned channel, std::uint32_t count);
  /// Stops the main loop for `time`, by default until the next reset. Interrupts go on.
  void hang(VirtualTime time = kNever);
  /// Makes the driver stay enabled longer after each reply. `by`: the additional time. Resets and power
  /// cycles do not change this setting.
  void release_driver_late(VirtualTime by);
  /// Makes the module receive and send at `baud` regardless of its settings; 0: its settings apply. A reply
  /// that has begun keeps its rate.
  void force_rate(std::uint32_t baud);
  /// Returns the rate and format in which the module receives; a rate of 0: it does not listen.
  [[nodiscard]] SerialMode mode() const { return mcu_ ? wire_.forced(mcu_->line.mode()) : SerialMode{}; }
  /// See ModuleWire::end_delays.
  void end_reply_delays(std::size_t fault);
  /// See ModuleWire::Begins and ModuleWire::Ends.
  void watch_replies(ModuleWire::Begins begins, ModuleWire::Ends ends) {
    wire_.watch(std::move(begins), std::move(ends));
  }
  /// Replaces the content of the memory with the `memory_image` of `settings`. The module loads these
  /// settings at its next start.
  void store(const Settings& settings) { memory_.contents() = memory_image(model_, settings); }
  /// Returns an image of the whole memory that contains `settings`; a blank image for factory settings.
  static std::vector<std::uint8_t> memory_image(const Model& model, const Settings& settings);

  /// Receives what happens to the module, for people: `power off`, `input 3 on`, `outputs 0005`, `settings
  /// stored`.
  using Event = std::function<void(const std::string& text)>;
  /// Tells of each event from now on.
  void tell(Event event);

  [[nodiscard]] const Model& model() const { return model_; }
  /// Returns the firmware's Module object. Call this only while the module is powered.
  [[nodiscard]] const Module& module() const { return mcu_->device.module(); }
  [[nodiscard]] std::uint16_t outputs() const { return outputs_.channels(); }
  /// Returns the levels at the terminals; bit n is channel n.
  [[nodiscard]] std::uint16_t input_levels() const { return inputs_.levels(); }
  [[nodiscard]] bool led_lit() const { return led_.lit(); }
  hal::doubles::Memory& memory() { return memory_; }
  [[nodiscard]] const hal::doubles::Memory& memory() const { return memory_; }
  hal::doubles::Outputs& output_pins() { return outputs_; }
  hal::doubles::StatusLed& led() { return led_; }
  /// Returns true if the module is starting up, waits for the end of a silence or of a turn-around time,
  /// processes a request, accesses its memory, or sends a reply. A silence of a shared ear does not count.
  /// Also returns true if a late reply waits or is on the wires.
  [[nodiscard]] bool pending() const;
  /// Returns how often the hardware watchdog has reset the module since this object was constructed.
  [[nodiscard]] std::uint64_t watchdog_resets() const { return watchdog_resets_; }
  /// Stops the tick until the next reset. Call this only while the module is powered.
  void stop_tick();

  // --- Station ---
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
  /// Sets the time of the next `run`. Calls Wires only if the time changes, because on an instant line most
  /// bytes do not change the time.
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
  VirtualTime driver_late_by_{0};
  bool switched_on_ = false;
  bool supply_interrupted_ = false;
  VirtualTime hangs_until_{0};  ///< 0: the main loop runs
  bool in_dcon_frame_ = false;  ///< perhaps: since the last CR or reply, a byte has arrived
  std::uint64_t watchdog_resets_ = 0;
  SerialMode listens_in_;  ///< the mode that the last call of `WireEnd::listen` has set
  // `receive` uses the members from here on. They are next to each other and occupy few cache lines.
  ModuleWire wire_;
  VirtualTime next_without_silence_ = kNever;
  VirtualTime runs_at_ = kNever;  ///< when Wires calls `run`
  std::optional<Mcu> mcu_;
};

}  // namespace ex9000::sim
