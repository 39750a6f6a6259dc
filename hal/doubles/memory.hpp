#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "hal/eeprom.hpp"

namespace ex9000::hal::doubles {

/// An AT24C64 of 8 KiB on a 100 kHz bus, at first all FF. It programs a page in 5 ms, a real one in up to 10.
class Memory {
 public:
  static constexpr std::size_t kSize = 8192;
  static constexpr std::size_t kPage = kEepromPage;
  static constexpr VirtualTime kByteOnBus = std::chrono::microseconds(90);
  static constexpr VirtualTime kProgram = std::chrono::milliseconds(5);

  explicit Memory(const VirtualClock& clock) : clock_(clock), contents_(kSize, 0xFF) {}

  void start_read(std::uint16_t address, MutableBytes destination, Time now);
  void start_write(std::uint16_t address, Bytes source, Time now);
  /// The job ends in `run` instead.
  bool poll(Time /*now*/) { return false; }
  [[nodiscard]] bool busy() const { return ends_ != kNever; }
  [[nodiscard]] bool succeeded() const { return succeeded_; }

  [[nodiscard]] VirtualTime next() const { return ends_; }
  void run();

  /// Ends the job as a power failure does, and at a reset of the MCU too, although a real EEPROM would go on.
  /// Of the bytes being programmed, the first ones are new, in proportion to the time so far. The next is
  /// partly erased: the old value OR A5h. The rest are old.
  void cut();

  /// Saves each programmed range outside. `run` calls it at the end of a write, which fails if the result is
  /// false; `cut` calls it for the range that may have changed and ignores the result. Not while jobs `fail`.
  using Keep = std::function<bool(std::uint16_t address, Bytes bytes)>;
  void keep(Keep keep) { keep_ = std::move(keep); }

  /// After each successful write, before the device gets the result.
  void on_write(std::function<void()> written) { written_ = std::move(written); }

  /// Each job then fails at its end, and no byte changes.
  void fail(bool on) { failing_ = on; }

  [[nodiscard]] const std::vector<std::uint8_t>& contents() const { return contents_; }
  std::vector<std::uint8_t>& contents() { return contents_; }
  /// Started writes, for the wear.
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
  VirtualTime ends_ = kNever;
  std::uint64_t writes_ = 0;
};

}  // namespace ex9000::hal::doubles
