#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/doubles/virtual_clock.hpp"
#include "hal/serial_line.hpp"
#include "hal/serial_mode.hpp"

namespace ex9000::hal::doubles {

/// A two-wire line to which a UART's driver is connected, for example the virtual bus.
class Wire {
 public:
  /// Turns the driver of this end on or off.
  virtual void drive(bool on) = 0;
  /// Begins to send `byte` with its start bit now. The driver is on.
  virtual void put(std::uint8_t byte, SerialMode mode) = 0;
  /// Returns the duration of `bytes` bytes without a gap.
  [[nodiscard]] virtual VirtualTime takes(std::size_t bytes, SerialMode mode) const = 0;

 protected:
  ~Wire() = default;
};

/// A UART that sends exactly at its baud rate. The owner of the wire passes received bytes to the device.
class SerialLine {
 public:
  /// The driver is on for these times before the first start bit and after the last stop bit, about the
  /// duration of one or two register writes. `release_late` extends the second time.
  static constexpr VirtualTime kDriverLead = std::chrono::microseconds(2);
  static constexpr VirtualTime kDriverTail = std::chrono::microseconds(2);

  SerialLine(VirtualClock& clock, Wire& wire) : clock_(clock), wire_(wire) {}

  void open(std::uint32_t baud, LineFormat format) { mode_ = {baud, format}; }
  void send(Bytes bytes);
  [[nodiscard]] bool sending() const { return driving_; }

  /// Returns the rate and format; the rate is 0 until `open`.
  [[nodiscard]] SerialMode mode() const { return mode_; }
  /// Delays the end of the driver enable by `by`. This also applies to a reply that is being sent.
  void release_late(VirtualTime by);
  /// Returns when `run` must be called.
  [[nodiscard]] VirtualTime next() const { return next_; }
  void run();
  /// Turns the driver off at once, even during a byte, as a power failure or a reset does.
  void abort();

 private:
  VirtualClock& clock_;
  Wire& wire_;
  SerialMode mode_;
  bool driving_ = false;
  Bytes bytes_;
  std::size_t sent_ = 0;
  VirtualTime first_start_bit_{0};
  VirtualTime next_ = kNever;
  VirtualTime over_ = kNever;  ///< when the driver must go off; kNever until the last byte is being sent
  VirtualTime late_by_{0};
};
static_assert(kIsSerialLine<SerialLine>);

}  // namespace ex9000::hal::doubles
