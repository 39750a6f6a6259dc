#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/model/line_format.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "hal/serial_mode.hpp"

namespace ex9000::hal::doubles {

/// A two-wire line to which a UART's driver is connected, for example the virtual bus.
class Wire {
 public:
  /// Returns the bytes that the UART sends instead of `bytes`. Called before the driver is turned on. The
  /// result must stay valid until the driver is turned off.
  virtual Bytes replaced(Bytes bytes) { return bytes; }
  /// Turns the UART's driver on or off.
  virtual void drive(bool on) = 0;
  /// Begins to send `bytes` without gaps: the first start bit begins now. Turning the driver off drops the
  /// rest. Call this only while the driver is on.
  virtual void put(Bytes bytes, SerialMode mode) = 0;
  /// Returns how long `bytes` bytes take if there is no gap between them.
  [[nodiscard]] virtual VirtualTime takes(std::size_t bytes, SerialMode mode) const = 0;

 protected:
  ~Wire() = default;
};

/// A UART that sends bytes without gaps; `Wire::takes` defines how long they take. It does not receive: the
/// simulated module passes received bytes directly to the device.
class SerialLine {
 public:
  /// How long the driver is on before the first start bit and after the last stop bit. `release_late` extends
  /// the time after the last stop bit.
  static constexpr VirtualTime kDriverLead = std::chrono::microseconds(2);
  static constexpr VirtualTime kDriverTail = std::chrono::microseconds(2);

  SerialLine(VirtualClock& clock, Wire& wire, TimingAt timing_at = LineTiming::at)
      : clock_(clock), wire_(wire), timing_at_(timing_at) {}

  [[nodiscard]] LineTiming timing(std::uint32_t baud, LineFormat format) const {
    return timing_at_(baud, format);
  }
  void open(std::uint32_t baud, LineFormat format) { mode_ = {baud, format}; }
  void send(Bytes bytes);
  [[nodiscard]] bool sending() const { return driving_; }

  /// Returns the baud rate and the line format. The baud rate is 0 before `open` and after `abort`.
  [[nodiscard]] SerialMode mode() const { return mode_; }
  /// Makes the driver stay on longer after each reply. `by`: the additional time. This also applies to a
  /// reply that is being sent.
  void release_late(VirtualTime by);
  /// Returns the time at which `run` must be called next; kNever if no reply is being sent.
  [[nodiscard]] VirtualTime next() const { return next_; }
  void run();
  /// Turns the driver off immediately, even during a byte, as a power failure or a reset does.
  void abort();

 private:
  VirtualClock& clock_;
  Wire& wire_;
  TimingAt timing_at_;
  SerialMode mode_;
  bool driving_ = false;
  Bytes bytes_;
  VirtualTime next_ = kNever;
  /// The time at which the driver turns off if `late_by_` is 0. kNever, except from the first start bit until
  /// the driver turns off.
  VirtualTime over_ = kNever;
  VirtualTime late_by_{0};
};

}  // namespace ex9000::hal::doubles
