#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/model/line_format.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "hal/serial_mode.hpp"

namespace ex9000::hal::doubles {

/// The two-wire line of a UART's driver, for example the virtual bus.
class Wire {
 public:
  /// What the UART sends instead of `bytes`, valid until its driver is off. Called before the driver is on.
  virtual Bytes replaced(Bytes bytes) { return bytes; }
  virtual void drive(bool on) = 0;
  [[nodiscard]] virtual bool low() const { return false; }
  /// Only while the driver is on. The first start bit begins now. Turning the driver off drops the rest.
  virtual void put(Bytes bytes, SerialMode mode) = 0;
  [[nodiscard]] virtual VirtualTime takes(std::size_t bytes, SerialMode mode) const = 0;

 protected:
  ~Wire() = default;
};

/// Sends without gaps. Does not receive: the simulated module passes received bytes directly to the device.
class SerialLine {
 public:
  /// The driver is on this long before the first start bit and after the last stop bit (see `release_late`).
  static constexpr VirtualTime kDriverLead = std::chrono::microseconds(2);
  static constexpr VirtualTime kDriverTail = std::chrono::microseconds(2);

  SerialLine(VirtualClock& clock, Wire& wire, TimingAt timing_at = LineTiming::at)
      : clock_(clock), wire_(wire), timing_at_(timing_at) {}

  [[nodiscard]] LineTiming timing(std::uint32_t baud, LineFormat format) const {
    return timing_at_(baud, format);
  }
  void open(std::uint32_t baud, LineFormat format) { mode_ = {baud, format}; }
  void send(Bytes bytes);
  void send_in_interrupt(Bytes bytes) { send(bytes); }
  [[nodiscard]] bool sending() const { return driving_; }
  [[nodiscard]] bool low() const { return wire_.low(); }

  /// The baud rate is 0 before `open` and after `abort`.
  [[nodiscard]] SerialMode mode() const { return mode_; }
  /// The driver stays on longer by `by` after each reply, also after one that is being sent.
  void release_late(VirtualTime by);
  /// When to call `run`; kNever if no reply is being sent.
  [[nodiscard]] VirtualTime next() const { return next_; }
  void run();
  /// As a power failure or a reset: the driver is off at once, even during a byte.
  void abort();

 private:
  VirtualClock& clock_;
  Wire& wire_;
  TimingAt timing_at_;
  SerialMode mode_;
  bool driving_ = false;
  Bytes bytes_;
  VirtualTime next_ = kNever;
  /// When the driver turns off if `late_by_` is 0. kNever, except from the first start bit until then.
  VirtualTime over_ = kNever;
  VirtualTime late_by_{0};
};

}  // namespace ex9000::hal::doubles
