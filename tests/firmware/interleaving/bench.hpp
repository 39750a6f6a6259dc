// A module on a simulated chip. The test controls the clock, the interrupts and the main loop.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "hal/device.hpp"
#include "hal/doubles/kept_word.hpp"
#include "hal/doubles/no_image_slots.hpp"
#include "hal/eeprom/two_places.hpp"
#include "hal/stellaris/gpio.hpp"
#include "hal/stellaris/uart.hpp"
#include "hal/tick.hpp"
#include "tests/support/interleaving/chip.hpp"

namespace ex9000::interleaving {

struct Board {
  Clock clock;
  hal::stellaris::Uart<0, 50'000'000, kDriverEnable, LineEndTimer> line;
  SilenceTimer silence_timer;
  WakeTimer wake_timer;
  Inputs inputs;
  Outputs outputs;
  hal::TwoPlaces<Memory> memory;
  InitSwitch init_switch;
  StatusLed status_led;
  Watchdog watchdog;
  hal::doubles::KeptWord kept_word;
  hal::doubles::NoImageSlots slots;
};

class Bench {
 public:
  /// Starts the module with the factory settings, 115200 baud and the changes that `change` makes. When the
  /// constructor returns, the module is idle.
  Bench(const char* model, const std::function<void(Settings&)>& change) : device_(*find_model(model)) {
    chip = &chip_;
    hal::bus::peripherals = &chip_;
    Settings settings = Settings::factory(*find_model(model));
    settings.baud_code = kFastest;
    change(settings);
    RecordBytes record{};
    write_record(*find_model(model), settings, 1, record);
    std::copy(record.begin(), record.end(),
              device_.board().memory.eeprom().contents.begin() + hal::kPlaces[0]);
    device_.start(ResetReason::PowerOn);
    rest(milliseconds(15));
    chip_.sent.clear();
  }
  ~Bench() {
    chip = nullptr;
    hal::bus::peripherals = nullptr;
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  Chip& hardware() { return chip_; }
  [[nodiscard]] const Module& module() const { return device_.module(); }

  [[nodiscard]] bool takes_bytes_for_its_echo() const { return !chip_.hears(); }

  /// Runs one turn of the main loop if there is work.
  void turn() {
    if (has_to_turn()) {
      turns_again_ = device_.turn();
    }
  }
  /// Runs one turn of the main loop.
  void whole_turn() { turns_again_ = device_.turn(); }

  /// Lets time pass while the main loop does its work.
  void rest(Duration length) {
    const std::uint32_t until = chip_.now + length.microseconds();
    turn_until_idle();
    while (chip_.next() <= until) {
      pass_time_until(chip_.next());
      turn_until_idle();
    }
    pass_time_until(until);
  }

  // --- external events; they may also occur in the middle of a turn of the main loop ---

  /// Lets one character time pass, and then delivers a byte to the UART.
  void byte(std::uint8_t value) {
    pass_time_until(chip_.now + Chip::kCharacter);
    interrupt([&] {
      chip_.receive(value);
      serve_uart();
    });
  }
  /// Keeps the line silent until the silence timer expires. Does nothing if this timer does not run.
  void silence() {
    if (chip_.silence_due != Chip::kNever) {
      pass_time_until(chip_.silence_due);
    }
  }
  void edge(unsigned channel, bool level) {
    pass_time_until(chip_.now + 5);
    interrupt([&] { device_.on_edge(channel, level); });
  }
  void tick() { pass_time_until(chip_.tick_due); }
  void memory_done() {
    if (chip_.memory_due != Chip::kNever) {
      pass_time_until(chip_.memory_due);
    }
  }
  /// Lets time pass until the reply in progress has been sent and the driver is off. Does nothing if the
  /// driver is off, or if the module has not written the first byte of the reply to the UART yet.
  void reply_leaves() {
    for (int i = 0; i < 1000 && chip_.driving() &&
                    (chip_.sent_due != Chip::kNever || chip_.line_end_due != Chip::kNever);
         ++i) {
      pass_time_until(std::min(chip_.sent_due, chip_.line_end_due));
    }
  }
  /// Lets time pass until the current byte of a reply has been sent. Does nothing if no byte is being sent.
  void reply_byte_leaves() {
    if (chip_.sent_due != Chip::kNever) {
      pass_time_until(chip_.sent_due);
    }
  }
  void bytes(const std::string& values) {
    for (const char value : values) {
      byte(static_cast<std::uint8_t>(value));
    }
  }

  /// The time, in microseconds, at which the last byte of a request was received. The key is the expected
  /// reply, or "host OK" if the request is a host OK. The key is empty if the test does not check this time.
  std::map<std::string, std::uint32_t> asked;
  /// Delivers all bytes of a request, and stores the time of the last byte in `asked` with the key `reply`.
  void asks(const std::string& frame, const std::string& reply) {
    bytes(frame);
    asked[reply] = chip_.now;
  }
  void is_asked(const std::string& reply) { asked[reply] = chip_.now; }

  // --- passing of time ---

  /// Lets time pass, and runs a turn of the main loop every 10 microseconds, even if there is no work. Call
  /// this only between turns.
  void rest_restlessly(Duration length) {
    constexpr std::uint32_t kStep = 10;
    for (std::uint32_t passed = 0; passed < length.microseconds(); passed += kStep) {
      pass_time_until(chip_.now + kStep);
      whole_turn();
    }
  }
  void pass_time_until(std::uint32_t time) {
    serve_pending();
    while (chip_.next() <= time) {
      chip_.now = std::max(chip_.now, chip_.next());
      interrupt([&] { serve_what_is_due(); });
    }
    chip_.now = std::max(chip_.now, time);
  }

 private:
  static constexpr std::uint8_t kFastest = 0x0A;

  template <class Code>
  void interrupt(Code code) {
    Points::interrupt(code);
  }

  void serve_uart() {
    while (chip_.interrupts()) {
      device_.board().line.on_interrupt(
          [&](std::uint8_t byte, ByteStatus status) { device_.on_receive(byte, status); });
    }
  }

  void serve_what_is_due() {
    const auto is_due = [&](std::uint32_t& due) {
      const bool is = due <= chip_.now;
      due = is ? Chip::kNever : due;
      return is;
    };
    if (is_due(chip_.tick_due)) {
      chip_.tick_due = chip_.now + hal::kTickPeriod.microseconds();
      ++chip_.ticks;
      device_.on_tick();
    }
    if (chip_.sent_due <= chip_.now) {
      chip_.shift();
      serve_uart();
    }
    if (is_due(chip_.silence_due)) {
      device_.on_silence();
    }
    if (is_due(chip_.line_end_due)) {
      if (device_.board().line.on_end_timer()) {
        device_.on_sent();
      }
    }
    if (is_due(chip_.wake_due)) {
      device_.on_wake_timer();
    }
    if (is_due(chip_.memory_due)) {
      device_.on_memory();
    }
  }

  [[nodiscard]] bool has_to_turn() const { return turns_again_ || device_.has_work(); }
  void turn_until_idle() {
    serve_pending();
    while (has_to_turn()) {
      turn();
      serve_pending();
    }
  }
  /// Serves the pending interrupts of the UART. For example, the transmit interrupt for the first byte of a
  /// reply becomes pending during a turn.
  void serve_pending() {
    interrupt([&] { serve_uart(); });
  }

  Chip chip_;
  hal::Device<Board> device_;
  bool turns_again_ = true;
};

}  // namespace ex9000::interleaving
