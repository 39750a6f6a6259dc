#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"

namespace ex9000::hal {

/// What no interrupt tells of, such as a bus that does not move, is noticed within this time.
constexpr Duration kMemoryPollPeriod = milliseconds(1);

/// A nonvolatile memory that takes its time, such as an AT24C64: one job at once, begun here and looked after
/// while the main loop goes on.
/// Where an interrupt tells that it can go on, that calls `Device::on_memory`.
class Memory {
 public:
  /// Begins to read `destination.size` bytes from `address` on. Main loop, only while not `busy()`; does not
  /// block. `destination` lives until then.
  virtual void start_read(std::uint16_t address, MutableBytes destination, Time now) = 0;

  /// Begins to write; the job never crosses a 32-byte page. Ends when the memory has programmed the bytes,
  /// not when it has taken them. `source` is read from the next call of `go_on` on, not before: whoever
  /// starts the job may still complete it. Likewise.
  virtual void start_write(std::uint16_t address, Bytes source, Time now) = 0;

  /// Goes on with the job. Main loop, behind every interrupt of the memory, and every `kMemoryPollPeriod`;
  /// does not block. True: must be called again at once, no interrupt will tell when.
  virtual bool go_on(Time now) = 0;

  /// Whether a job is under way. Main loop.
  [[nodiscard]] virtual bool busy() const = 0;

  /// Whether the last job succeeded; false where the memory did not answer or took longer than its data sheet
  /// says. Main loop, while not `busy()`.
  [[nodiscard]] virtual bool succeeded() const = 0;

 protected:
  ~Memory() = default;
};

}  // namespace ex9000::hal
