// An I2C transfer, its result, and the functions that a driver of an I2C master must have.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"

namespace ex9000::hal {

/// A transfer to or from a device: START, address, bytes in one direction, STOP. A driver of a master has the
/// following functions. Except `on_interrupt`, they are for the main loop only and do not block.
///
///     void begin(const I2cTransfer&, Time now)
///         Begins a transfer. Call this only while not `busy()`. The transfer must stay valid while `busy()`.
///     bool poll(Time now)
///         Continues the transfer or the recovery of the bus. Call this in every pass of the main loop and,
///         while `busy()`, after each interrupt of the master and at least every `kMemoryPollPeriod`
///         (hal/memory.hpp). If this returns true, call it again immediately, because no interrupt will
///         occur.
///     bool busy() const
///         Returns whether a transfer is running.
///     I2cResult result() const
///         Returns the result of the last transfer. Call this only while not `busy()`.
///     void start()
///         Begins the recovery of the bus (hal/i2c_bus_recovery.hpp). Once, before the other functions.
///         Transfers wait until the recovery has ended.
///     void on_interrupt()
///         For the interrupt of the master, which then calls `Device::on_memory`.
struct I2cTransfer {
  std::uint8_t device = 0;   ///< address of the device, 7 bits
  Bytes header;              ///< bytes to write first; if empty, the transfer reads
  Bytes source;              ///< bytes to write after the header
  MutableBytes destination;  ///< buffer for a read

  [[nodiscard]] constexpr bool writes() const { return header.size != 0; }
  [[nodiscard]] constexpr std::size_t size() const {
    return writes() ? header.size + source.size : destination.size;
  }
  /// Returns the byte to write at position `index`.
  [[nodiscard]] constexpr std::uint8_t byte(std::size_t index) const {
    return index < header.size ? header[index] : source[index - header.size];
  }
};

enum class I2cResult : std::uint8_t {
  Done,
  NoAcknowledge,  ///< no device acknowledged the address, or a byte was not acknowledged
  Failed,         ///< any other error, for example an expired timeout or lost arbitration
};

}  // namespace ex9000::hal
