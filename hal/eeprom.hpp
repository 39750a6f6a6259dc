#pragma once

#include <cstddef>

namespace ex9000::hal {

/// The smallest page of any supported EEPROM, in bytes. No write crosses its end, so a power failure damages
/// at most one page.
inline constexpr std::size_t kEepromPage = 32;

/// An EEPROM or FRAM, for example an AT24C64: one job at a time. For the main loop; nothing blocks.
/// `start_...` and `succeeded` only while not `busy()`; buffers must stay valid while `busy()`.
///     void start_read(std::uint16_t address, MutableBytes destination, Time now)
///     void start_write(std::uint16_t address, Bytes source, Time now)
///         `source` must not cross the end of a page. Ends when the bytes are programmed, not just received.
///     bool poll(Time now)        As in hal/memory.hpp.
///     bool busy() const          A job is running.
///     bool succeeded() const     The last job; it fails, for example, if the driver's timeout expires first.

}  // namespace ex9000::hal
