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

/// Simulates an AT24C64 of 8 KiB on a 100 kHz bus. At first, all bytes are FF. This double takes 5 ms to
/// program a page; a real AT24C64 may take up to 10 ms.
class Memory {
 public:
  static constexpr std::size_t kSize = 8192;
  static constexpr std::size_t kPage = kEepromPage;
  static constexpr VirtualTime kByteOnBus = std::chrono::microseconds(90);
  static constexpr VirtualTime kProgram = std::chrono::milliseconds(5);

  explicit Memory(const VirtualClock& clock) : clock_(clock), contents_(kSize, 0xFF) {}

  void start_read(std::uint16_t address, MutableBytes destination, Time now);
  void start_write(std::uint16_t address, Bytes source, Time now);
  /// Has no effect, because the job ends in `run`.
  bool poll(Time /*now*/) { return false; }
  [[nodiscard]] bool busy() const { return ends_ != kNever; }
  [[nodiscard]] bool succeeded() const { return succeeded_; }

  [[nodiscard]] VirtualTime next() const { return ends_; }
  void run();

  /// Ends the job as a power failure does. The simulator also calls this at a reset of the MCU, although a
  /// real EEPROM would then continue to program. If the job is programming bytes, the first of these bytes
  /// have their new values; the number of new bytes is proportional to the time since programming began. The
  /// next byte is partly erased: its value is the old value OR A5h. The other bytes have their old values.
  void cut();

  /// A function that saves each programmed range outside this object. `run` calls this function at the end of
  /// a write; if the result is false, the write fails. If `cut` ends a write, `cut` calls this function for
  /// the range that may have changed, and ignores the result. If jobs are set to fail (see `fail`), neither
  /// `run` nor `cut` calls this function.
  using Keep = std::function<bool(std::uint16_t address, Bytes bytes)>;
  void keep(Keep keep) { keep_ = std::move(keep); }

  /// Sets a function that is called after each successful write, before the device gets the result.
  void on_write(std::function<void()> written) { written_ = std::move(written); }

  /// Sets whether jobs fail. If `on` is true, each job fails at its end, and neither `run` nor `cut` changes
  /// a byte.
  void fail(bool on) { failing_ = on; }

  [[nodiscard]] const std::vector<std::uint8_t>& contents() const { return contents_; }
  std::vector<std::uint8_t>& contents() { return contents_; }
  /// Returns the number of started writes, for the calculation of wear.
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
