#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/doubles/virtual_clock.hpp"
#include "hal/serial_line.hpp"

namespace ex9000::hal::doubles {

/// Two wires that a UART's driver can be put on. The virtual bus is one.
class Wire {
 public:
  /// This end's driver goes on or off.
  virtual void drive(bool on) = 0;
  /// The start bit of `byte` begins now; the driver is on. Start, 8 data, stop at `baud`.
  virtual void put(std::uint8_t byte, std::uint32_t baud) = 0;
  /// How long so many bytes without a gap take at `baud`.
  [[nodiscard]] virtual VirtualTime takes(std::size_t bytes, std::uint32_t baud) const = 0;

 protected:
  ~Wire() = default;
};

/// A UART that sends at exactly its rate. What it receives is handed to the device by whoever owns the wire.
class SerialLine {
 public:
  /// Driver on before the first start bit, and after the last stop bit: like a register write or two; that
  /// is, where it is not made to go off late.
  static constexpr VirtualTime kDriverLead = std::chrono::microseconds(2);
  static constexpr VirtualTime kDriverTail = std::chrono::microseconds(2);

  SerialLine(VirtualClock& clock, Wire& wire) : clock_(clock), wire_(wire) {}

  void open(std::uint32_t baud) { baud_ = baud; }
  void send(Bytes bytes);
  [[nodiscard]] bool sending() const { return driving_; }

  /// 0 until it is opened.
  [[nodiscard]] std::uint32_t baud() const { return baud_; }
  /// By how much later its driver goes off than it should, this one's too.
  void release_late(VirtualTime by);
  /// When `run` has something to do.
  [[nodiscard]] VirtualTime next() const { return next_; }
  void run();
  /// Power or reset takes the driver off in the middle of a byte.
  void abort();

 private:
  VirtualClock& clock_;
  Wire& wire_;
  std::uint32_t baud_ = 0;
  bool driving_ = false;
  Bytes bytes_;
  std::size_t sent_ = 0;
  VirtualTime first_start_bit_{0};
  VirtualTime next_ = kNever;
  VirtualTime over_ = kNever;  ///< when the driver should go off, once the last byte is under way
  VirtualTime late_by_{0};
};
static_assert(kIsSerialLine<SerialLine>);

}  // namespace ex9000::hal::doubles
