// Runs hal::Device on peripherals that are plain values, in virtual microseconds. The module of the simulator
// also requires a bus, which makes it too slow: a fuzz target must run a hundred million modules in about an
// hour.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/model/model.hpp"
#include "hal/device.hpp"
#include "hal/eeprom/two_places.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/oracles/judges/time.hpp"

namespace ex9000::fuzz {

using judges::kMillisecond;
using judges::kNever;
using judges::Microseconds;

/// Observes the replies, the outputs and the turns of a module.
class ModuleObserver {
 public:
  /// Called when the module has switched its RS-485 driver on. `reply`: the complete reply.
  virtual void reply_begins(Bytes reply) = 0;
  /// Called when the RS-485 driver has been switched off.
  virtual void reply_ends() = 0;
  virtual void outputs_change(std::uint16_t channels) = 0;
  /// Called when the main loop has completed one turn. After the start, settings and outputs change only in a
  /// turn.
  virtual void turned() = 0;

 protected:
  ~ModuleObserver() = default;
};

/// The state that survives a reset.
struct Surroundings {
  explicit Surroundings(ModuleObserver& observed_by) : observer(observed_by) { memory.fill(0xFF); }

  ModuleObserver& observer;
  Microseconds now = 0;
  std::uint16_t input_levels = 0;
  bool init_asserted = false;
  bool memory_answers = true;
  /// The part of the EEPROM that the core uses.
  std::array<std::uint8_t, 0x100> memory{};
};

/// The board interface is described in hal/device.hpp.
struct LeanBoard {
  LeanBoard(Surroundings& surroundings, TimingAt timing_at)
      : clock{surroundings},
        line{surroundings, timing_at},
        silence_timer{surroundings},
        wake_timer{surroundings},
        inputs{surroundings},
        outputs{surroundings},
        memory(Eeprom{surroundings}),
        init_switch{surroundings} {}

  struct Clock {
    Surroundings& around;
    [[nodiscard]] Time now() const { return Time(static_cast<std::uint32_t>(around.now)); }
    [[nodiscard]] Time now_in_interrupt() const { return now(); }
  };

  struct Line {
    Surroundings& around;
    TimingAt timing_at;
    std::uint32_t baud = 0;
    LineFormat format = LineFormat::k8N1;
    Microseconds ends = kNever;

    [[nodiscard]] LineTiming timing(std::uint32_t its_baud, LineFormat its_format) const {
      return timing_at(its_baud, its_format);
    }
    void open(std::uint32_t its_baud, LineFormat its_format) {
      baud = its_baud;
      format = its_format;
    }
    void send(Bytes bytes) {
      ends = around.now + 4 + bytes.size * bits_of_character(format) * 1'000'000ULL / baud;
      around.observer.reply_begins(bytes);
    }
    [[nodiscard]] bool sending() const { return ends != kNever; }
  };

  struct SilenceTimer {
    Surroundings& around;
    Microseconds fires = kNever;
    void restart(Duration after) { fires = around.now + after.microseconds(); }
  };

  struct WakeTimer {
    Surroundings& around;
    Microseconds fires = kNever;
    void restart(Duration after) { fires = around.now + after.microseconds(); }
  };

  struct Inputs {
    Surroundings& around;
    [[nodiscard]] std::uint16_t start() const { return around.input_levels; }
  };

  struct Outputs {
    Surroundings& around;
    std::uint16_t driven = 0;
    void drive(std::uint16_t channels) {
      if (channels != driven) {
        driven = channels;
        around.observer.outputs_change(channels);
      }
    }
  };

  /// An EEPROM on a 100 kHz bus. The EEPROM takes 5 ms to program a page.
  struct Eeprom {
    Surroundings& around;
    Microseconds ends = kNever;
    Microseconds began = 0;
    bool ok = true;
    std::uint16_t at = 0;
    Bytes source{};
    MutableBytes destination{};

    void start_read(std::uint16_t address, MutableBytes bytes, Time /*now*/) {
      start(address, bytes.size, 0);
      destination = bytes;
      source = {};
    }
    void start_write(std::uint16_t address, Bytes bytes, Time /*now*/) {
      constexpr Microseconds kProgram = 5000;
      constexpr unsigned kPage = 32;
      require(address / kPage == (address + bytes.size - 1) / kPage, "a write stays within its page");
      start(address, bytes.size, kProgram);
      source = bytes;
    }
    void start(std::uint16_t address, std::size_t size, Microseconds program) {
      constexpr Microseconds kByteOnBus = 90;
      constexpr std::size_t kAddressing = 4;
      require(!busy(), "the module starts one memory job at a time");
      require(size != 0 && address + size <= around.memory.size(),
              "a memory job stays within the part of the memory that the core uses");
      at = address;
      began = around.now;
      ends = began + (size + kAddressing) * kByteOnBus + program;
    }
    static bool poll(Time /*now*/) { return false; }
    [[nodiscard]] bool busy() const { return ends != kNever; }
    [[nodiscard]] bool succeeded() const { return ok; }
    void finish() {
      ends = kNever;
      ok = around.memory_answers;
      if (!ok) {
        return;
      }
      if (source.size != 0) {
        std::copy(source.begin(), source.end(), around.memory.begin() + at);
      } else {
        std::copy_n(around.memory.begin() + at, destination.size, destination.data);
      }
    }
    /// Simulates a supply failure. A write in progress has stored its first bytes, in proportion to the
    /// elapsed time, and may have corrupted the next byte. If the memory does not acknowledge, changes
    /// nothing.
    void cut() {
      if (!busy() || source.size == 0 || !around.memory_answers) {
        return;
      }
      const std::size_t done = source.size * (around.now - began) / (ends - began + 1);
      std::copy_n(source.begin(), done, around.memory.begin() + at);
      around.memory[at + done] |= 0xA5U;
    }
  };

  struct InitSwitch {
    Surroundings& around;
    [[nodiscard]] bool asserted() const { return around.init_asserted; }
  };

  struct StatusLed {
    static void light(bool /*on*/) {}
  };

  struct Watchdog {
    static void feed() {}
  };

  Clock clock;
  Line line;
  SilenceTimer silence_timer;
  WakeTimer wake_timer;
  Inputs inputs;
  Outputs outputs;
  hal::TwoPlaces<Eeprom> memory;
  InitSwitch init_switch;
  StatusLed status_led;
  Watchdog watchdog;
};

class LeanModule {
 public:
  /// Creates a module without power.
  LeanModule(const Model& model, ModuleObserver& observer, TimingAt timing_at)
      : model_(model), timing_at_(timing_at), around_(observer) {}

  /// Switches the module on. If it is on already, this is a power cycle, which interrupts a write in
  /// progress. Returns when the module has started; aborts if this takes more than 100 ms.
  void reset() {
    if (device_) {
      board().memory.eeprom().cut();
      device_.reset();
    }
    held_ = false;
    const Microseconds began = around_.now;
    device_.emplace(model_, LeanBoard(around_, timing_at_));
    device_->start(ResetReason::PowerOn);
    main_loop();
    constexpr Microseconds kLongest = 100 * kMillisecond;  // wire.md D13
    while (!module().listening()) {
      const Microseconds next = next_event();
      require(next <= began + kLongest, "a module listens within 100 ms of a reset");
      advance_to(next);
    }
  }

  /// Lets time pass until `until`. Runs all events up to and including this time.
  void advance_to(Microseconds until) {
    for (Microseconds next = next_event(); next <= until; next = next_event()) {
      around_.now = std::max(around_.now, next);
      happen();
    }
    around_.now = until;
  }
  void wait(Microseconds time) { advance_to(around_.now + time); }

  /// Delivers a byte whose stop bit ends now. Do not call this while `sending()`: the module cannot receive
  /// then.
  void receive(std::uint8_t byte, ByteStatus status) {
    device_->on_receive(byte, status);
    look();
  }
  [[nodiscard]] bool sending() { return board().line.sending(); }

  void toggle_input(unsigned channel) {
    around_.input_levels = static_cast<std::uint16_t>(around_.input_levels ^ (1U << channel));
    if (channel < model_.inputs) {
      device_->on_edge(channel, (around_.input_levels >> channel & 1U) != 0);
      look();
    }
  }
  void tick() {
    device_->on_tick();
    main_loop();
  }
  /// Stops the main loop, or lets it continue. Interrupts also occur while the main loop is stopped.
  void hold(bool held) {
    held_ = held;
    main_loop();
  }
  [[nodiscard]] bool held() const { return held_; }

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] const Module& module() const { return device_->module(); }
  [[nodiscard]] Microseconds now() const { return around_.now; }
  Surroundings& around() { return around_; }

 private:
  LeanBoard& board() { return device_->board(); }

  Microseconds next_event() {
    LeanBoard& its = board();
    return std::min(std::min(its.line.ends, its.memory.eeprom().ends),
                    std::min(its.silence_timer.fires, its.wake_timer.fires));
  }

  void happen() {
    LeanBoard& its = board();
    if (its.line.ends <= around_.now) {
      its.line.ends = kNever;
      around_.observer.reply_ends();
      device_->on_sent();
    }
    if (its.memory.eeprom().ends <= around_.now) {
      its.memory.eeprom().finish();
    }
    if (its.silence_timer.fires <= around_.now) {
      its.silence_timer.fires = kNever;
      device_->on_silence();
    }
    if (its.wake_timer.fires <= around_.now) {
      its.wake_timer.fires = kNever;
      device_->on_wake_timer();
    }
    main_loop();
  }

  /// Runs the main loop if an interrupt has left work for it. Most interrupts leave none.
  void look() {
    if (device_->has_work()) {
      main_loop();
    }
  }

  /// Runs turns until there is no work left. This takes no virtual time. Has no effect while the main loop is
  /// stopped.
  void main_loop() {
    if (held_) {
      return;
    }
    unsigned turns = 0;
    bool again = true;
    while (again) {
      constexpr unsigned kMostTurns = 50;
      require(++turns < kMostTurns, "the main loop completes its work in fewer than 50 turns");
      again = device_->turn() || device_->has_work();
      around_.observer.turned();
    }
  }

  const Model& model_;
  TimingAt timing_at_;
  Surroundings around_;
  std::optional<hal::Device<LeanBoard>> device_;
  bool held_ = false;
};

}  // namespace ex9000::fuzz
