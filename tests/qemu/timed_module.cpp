#include "tests/qemu/timed_module.hpp"

#include <algorithm>
#include <stdexcept>

namespace ex9000::rig {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

void TimedModule::begin_anew(const Settings* settings) {
  halt();
  renew(settings);
  now_ = nanoseconds(0);
  come_up();
}

void TimedModule::power(bool on) {
  if (on == powered()) {
    return;
  }
  lamp_.forget();
  halt();
  supply(on);
  if (on) {
    come_up();
  }
}

void TimedModule::kill() {
  lamp_.forget();
  clock_.reset();
  EmulatedBoard::kill();
}

void TimedModule::reset() {
  if (powered()) {
    halt();
    pull_reset();
    come_up();
  }
}

void TimedModule::come_up() {
  lamp_.forget();
  if (!clock_) {
    clock_.emplace(emulator());
  }
  clock_->set_up();
}

void TimedModule::halt() {
  if (clock_) {
    clock_->halt();
  }
}

void TimedModule::set_input(unsigned channel, bool level) {
  if (channel < model().inputs) {
    set_level(channel, level);
    run_for(microseconds(100));
  }
}

void TimedModule::pulse_input(unsigned channel, std::uint32_t count) {
  if (channel < model().inputs && powered()) {
    now_ += clock_->make_edges(input_pin(channel), 2 * count);
    lamp_.look(now_, clock_->led_lit());
  }
}

void TimedModule::run_for(nanoseconds time) { run_until(now_ + time); }

void TimedModule::run_until(nanoseconds when) {
  // Shorter than the shortest phase of a flashing LED, so that LampWatch misses no phase.
  constexpr milliseconds kAtOnce{50};
  while (powered() && now_ < when) {
    const nanoseconds time = std::min<nanoseconds>(when - now_, kAtOnce);
    clock_->run_for(time);
    now_ += time;
    lamp_.look(now_, clock_->led_lit());
  }
  now_ = std::max(now_, when);
}

void TimedModule::run_to_reset(const std::string& event, nanoseconds time) {
  try {
    run_for(time);
  } catch (const Halted&) {
  }
  emulator().qmp().wait_for(event);
}

void TimedModule::verify_led() {
  if (lamp_.until()) {
    run_until(*lamp_.until());
  }
}

/// Disables the I2C interrupt, or enables it again. A real EEPROM takes milliseconds to store, but the
/// emulated one takes no time, so a request would never arrive while the image stores. A disabled interrupt
/// has the same effect as an EEPROM that stretches the clock of its bus. The image waits for each byte on
/// this bus for at most 3 ms.
void TimedModule::hold_memory(bool hold) {
  constexpr std::uint32_t kSetEnable = 0xE000'E100;
  constexpr std::uint32_t kClearEnable = 0xE000'E180;
  constexpr std::uint32_t kI2c0 = 1U << 8U;
  emulator().bus().write(hold ? kClearEnable : kSetEnable, kI2c0);
}

void TimedModule::send(const Bytes& bytes, SerialMode mode) {
  constexpr milliseconds kLongestHold{2};
  constexpr microseconds kSlice{200};
  // On a real line, the driver enable goes off soon after the last byte of a reply has arrived at the master.
  // Here, this byte arrives immediately, while the driver enable is still on. Therefore this function waits
  // until the driver enable is off.
  constexpr milliseconds kLongestWait{100};
  const nanoseconds gives_up = now_ + kLongestWait;
  while (speaks() && now_ < gives_up) {
    run_for(kSlice);
  }
  const nanoseconds begin = now_;
  const nanoseconds end = begin + duration_in(mode, bytes.size());
  if (powered()) {
    hold_memory(true);
    bool held = true;
    const auto go_to = [&](nanoseconds when) {
      if (held && when >= begin + kLongestHold) {
        run_until(begin + kLongestHold);
        hold_memory(false);
        held = false;
      }
      run_until(when);
    };
    for (const Arrival& arrival : heard_in_mode(bytes, mode, this->mode())) {
      go_to(begin + arrival.at);
      put(arrival);
    }
    go_to(std::max(now_, end));
    if (held) {
      hold_memory(false);
    }
  }
  run_until(end);
}

void TimedModule::put(const Arrival& arrival) {
  if (clock_->driver_on()) {
    return;
  }
  if (!clock_->receiver_empty()) {
    throw std::runtime_error(
        "UART0: a byte arrives before the image has read the previous byte; expected the image to read each "
        "byte in time");
  }
  if (arrival.status == ByteStatus::Good) {
    emulator().uart().send(&arrival.byte, 1);
  } else {
    emulator().send_break();
  }
  constexpr std::uint32_t kUartFlags = 0x4000'C018;
  constexpr std::uint32_t kReceiverEmpty = 1U << 4U;
  while ((emulator().bus().read(kUartFlags) & kReceiverEmpty) != 0) {
  }
}

TimedModule::Bytes TimedModule::hear(SerialMode mode) {
  Bytes sent;
  if (powered()) {
    for (Bytes more = emulator().uart().receive(nanoseconds(0)); !more.empty();
         more = emulator().uart().receive(nanoseconds(0))) {
      sent.insert(sent.end(), more.begin(), more.end());
    }
  }
  Bytes heard;
  if (!sent.empty()) {
    for (const Arrival& arrival : heard_in_mode(sent, this->mode(), mode)) {
      heard.push_back(arrival.byte);
    }
  }
  return heard;
}

}  // namespace ex9000::rig
