#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "hal/doubles/virtual_clock.hpp"
#include "hal/memory.hpp"

namespace ex9000::hal::doubles {

/// An AT24C64 as the core sees it: 8 KiB, erased to FF, on a 100 kHz bus, 5 ms to program a page. Loses power
/// in the middle of a job if told so.
class Memory {
 public:
  static constexpr std::size_t kSize = 8192;
  static constexpr std::size_t kPage = 32;
  static constexpr VirtualTime kByteOnBus = std::chrono::microseconds(90);
  static constexpr VirtualTime kProgram = std::chrono::milliseconds(5);

  explicit Memory(const VirtualClock& clock) : clock_(clock), contents_(kSize, 0xFF) {}

  void start_read(std::uint16_t address, MutableBytes destination, Time now);
  void start_write(std::uint16_t address, Bytes source, Time now);
  /// The virtual clock does: `run`.
  bool poll(Time /*now*/) { return false; }
  [[nodiscard]] bool busy() const { return ends_ != kNever; }
  [[nodiscard]] bool succeeded() const { return succeeded_; }

  [[nodiscard]] VirtualTime next() const { return ends_; }
  void run();

  /// The supply fails or the MCU is reset. A write under way leaves the page as far as it got: the first
  /// bytes new, in proportion to the time it had, one byte spoiled, the rest old.
  void cut();

  /// Told of every range that has been programmed, before the job is over, for contents that are to outlive
  /// this object; false: that cannot be had, and the job fails.
  using Keep = std::function<bool(std::uint16_t address, Bytes bytes)>;
  void keep(Keep keep) { keep_ = std::move(keep); }

  /// Called behind every write that has succeeded, before whoever started it knows.
  void on_write(std::function<void()> written) { written_ = std::move(written); }

  /// From now on no job succeeds, and nothing is written.
  void fail(bool on) { failing_ = on; }

  [[nodiscard]] const std::vector<std::uint8_t>& contents() const { return contents_; }
  std::vector<std::uint8_t>& contents() { return contents_; }
  /// Writes that have changed or could have changed something, for wear.
  [[nodiscard]] std::uint64_t writes() const { return writes_; }

 private:
  void begin(bool writing, std::uint16_t address, std::size_t size);
  bool kept(std::size_t size);

  const VirtualClock& clock_;
  std::vector<std::uint8_t> contents_;
  Keep keep_;
  std::function<void()> written_;
  bool failing_ = false;
  bool succeeded_ = true;
  bool writing_ = false;
  std::uint16_t address_ = 0;
  Bytes source_;
  MutableBytes destination_;
  VirtualTime began_{0};
  VirtualTime ends_ = kNever;
  std::uint64_t writes_ = 0;
};
static_assert(kIsMemory<Memory>);

}  // namespace ex9000::hal::doubles
