// An I2C transfer, and the functions of a driver of an I2C master.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"

namespace ex9000::hal {

/// START, address, bytes in one direction, STOP. A master has these functions, for the main loop except
/// `on_interrupt`; nothing blocks.
///     void start()                    Once, first: recovers the bus (hal/i2c_bus_recovery.hpp). Transfers
///                                     wait for the end of this.
///     void begin(const I2cTransfer&, Time now)
///                                     Only while not `busy()`. The transfer stays valid while `busy()`.
///     bool poll(Time now)             Continues the transfer or the recovery: in every pass; while `busy()`
///                                     also after each interrupt of the master and every `kMemoryPollPeriod`
///                                     (hal/memory.hpp). If true, again at once: no interrupt will occur.
///     bool busy() const
///     I2cResult result() const        Of the last transfer. Only while not `busy()`.
///     void on_interrupt()             From the master's interrupt, which then calls `Device::on_memory`.
struct I2cTransfer {
  std::uint8_t device = 0;   ///< address of the device, 7 bits
  Bytes header;              ///< bytes to write first; if empty, the transfer reads
  Bytes source;              ///< bytes to write after the header
  MutableBytes destination;  ///< buffer for a read

  [[nodiscard]] constexpr bool writes() const { return header.size != 0; }
  [[nodiscard]] constexpr std::size_t size() const {
    return writes() ? header.size + source.size : destination.size;
  }
  /// The byte to write at `index`.
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
