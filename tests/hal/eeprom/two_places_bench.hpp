// An EEPROM that can fail, and a module's settings in this EEPROM, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/settings/settings_keeper.hpp"
#include "hal/eeprom/two_places.hpp"
#include "tests/hal/numbered_settings.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000 {

inline constexpr std::size_t kPage = 32;
inline constexpr std::size_t kAttempts = 3;
/// The number of reads of a load if the EEPROM never answers: three reads at the first place, and one at the
/// other.
inline constexpr std::size_t kReadsOfASilentEeprom = kAttempts + 1;
/// An offset in a page. A record contains the module's address at this offset in its first page.
inline constexpr std::size_t kStuckCell = 4;

/// Thrown when the power fails during a write.
struct PowerFailure {};

/// An EEPROM (hal/eeprom.hpp) of kStoredMemory bytes. Each job ends at once. The public members
/// determine how it fails, and record what it has done.
class FakeEeprom {
 public:
  enum class Garbage { None, Zeroes, Ones, MixedWithOld, MixedWithNew };
  static constexpr Garbage kEveryGarbage[] = {Garbage::None, Garbage::Zeroes, Garbage::Ones,
                                              Garbage::MixedWithOld, Garbage::MixedWithNew};

  void start_read(std::uint16_t address, MutableBytes destination, Time /*now*/) {
    if (is_in_a_page(address, destination.size)) {
      reads.push_back(address);
      succeeded_ = read(address, destination);
    }
  }
  void start_write(std::uint16_t address, Bytes source, Time /*now*/) {
    if (is_in_a_page(address, source.size)) {
      writes.push_back(address);
      succeeded_ = write(address, source);
    }
  }
  static bool poll(Time /*now*/) { return false; }
  static bool busy() { return false; }
  [[nodiscard]] bool succeeded() const { return succeeded_; }

  std::vector<std::uint8_t> cells = std::vector<std::uint8_t>(kStoredMemory, 0xFF);
  std::size_t good_jobs = 0;             ///< number of jobs before the failures of the next members begin
  std::size_t failing_reads = 0;         ///< number of the next reads that the memory does not answer
  std::size_t noisy_reads = 0;           ///< number of the next reads that return a wrong bit
  std::size_t unanswered_writes = 0;     ///< number of the next writes that the memory does not answer
  bool unanswered_but_done = false;      ///< the memory stores the data of writes that it does not answer
  std::size_t ignored_after = SIZE_MAX;  ///< after this many more writes, writes are answered but not done
  bool stuck = false;                    ///< the byte at kStuckCell cannot be written in any page
  std::optional<std::size_t> power;      ///< if set, the power fails after this many more bytes are written
  Garbage garbage = Garbage::None;       ///< content of the byte that is being written when the power fails
  std::vector<std::uint16_t> reads;      ///< addresses of all reads
  std::vector<std::uint16_t> writes;     ///< addresses of all writes
  std::size_t bytes_written = 0;

 private:
  bool is_in_a_page(std::size_t address, std::size_t size) {
    succeeded_ =
        size != 0 && address + size <= cells.size() && address / kPage == (address + size - 1) / kPage;
    EXPECT_TRUE(succeeded_) << "a job crosses the end of a page or of the EEPROM";
    return succeeded_;
  }
  /// Returns whether `failures` is not 0 and applies to this job, and counts it down.
  bool fails(std::size_t& failures) const {
    const bool now = good_jobs == 0 && failures != 0;
    failures -= now ? 1 : 0;
    return now;
  }

  bool read(std::uint16_t address, MutableBytes destination) {
    const bool answers = !fails(failing_reads);
    if (answers) {
      std::copy_n(cells.begin() + address, destination.size, destination.data);
      destination.data[destination.size / 2] ^= fails(noisy_reads) ? 0x10U : 0U;
    }
    good_jobs -= good_jobs != 0 ? 1 : 0;
    return answers;
  }

  bool write(std::uint16_t address, Bytes source) {
    const bool answers = !fails(unanswered_writes);
    good_jobs -= good_jobs != 0 ? 1 : 0;
    if ((!answers && !unanswered_but_done) || ignored_after == 0) {
      return answers;
    }
    ignored_after -= ignored_after != SIZE_MAX ? 1 : 0;
    for (std::size_t i = 0; i < source.size; ++i) {
      std::uint8_t& cell = cells[address + i];
      if (power && *power == 0) {
        cell = spoiled(cell, source[i]);
        throw PowerFailure();
      }
      if (power) {
        --*power;
      }
      if (!stuck || (address + i) % kPage != kStuckCell) {
        cell = source[i];
      }
      ++bytes_written;
    }
    if (power && *power == 0) {
      throw PowerFailure();  // all bytes of the job are written, but the firmware gets no answer
    }
    return answers;
  }

  [[nodiscard]] std::uint8_t spoiled(std::uint8_t old_byte, std::uint8_t new_byte) const {
    switch (garbage) {
      case Garbage::Zeroes:
        return 0x00;
      case Garbage::Ones:
        return 0xFF;
      case Garbage::MixedWithOld:
        return static_cast<std::uint8_t>(old_byte ^ 0xA5U);
      case Garbage::MixedWithNew:
        return static_cast<std::uint8_t>(new_byte ^ 0x5AU);
      case Garbage::None:
        break;
    }
    return old_byte;
  }

  bool succeeded_ = false;
};

/// A module's settings in an EEPROM, from one reset to the next.
class Boot {
 public:
  explicit Boot(FakeEeprom& eeprom, const Model& which = the_model()) : memory_(eeprom), keeper_(which) {
    drive();
  }
  /// Saves `settings` as for a command. Returns whether the save succeeded; false if the power failed.
  bool save(const Settings& settings) {
    keeper_.save(settings, now_);
    return drive() && keeper_.saved();
  }
  /// Lets `time` pass while `in_force` are the settings in force. Returns whether the keeper has begun an
  /// action, which has then ended.
  bool pass(Duration time, const Settings& in_force) {
    now_ = now_ + time;
    keeper_.poll(in_force, now_);
    const bool acted = keeper_.busy();
    drive();
    return acted;
  }
  [[nodiscard]] const Settings& stored() const { return keeper_.stored(); }
  [[nodiscard]] SettingsSource source() const { return keeper_.source(); }
  SettingsKeeper& keeper() { return keeper_; }

 private:
  /// Runs all jobs. Returns false if the power failed.
  bool drive() {
    try {
      while (keeper_.busy()) {
        memory_.start(keeper_.job(), now_);
        while (memory_.busy()) {
          memory_.poll(now_);
        }
        keeper_.done(memory_.result());
      }
    } catch (const PowerFailure&) {
      return false;
    }
    return true;
  }

  hal::TwoPlaces<FakeEeprom&> memory_;
  SettingsKeeper keeper_;
  Time now_{1000};
};

/// The addresses of the two copies.
inline constexpr std::uint16_t kCopies[] = {0x000, 0x080};

inline void put(FakeEeprom& eeprom, std::size_t copy, const Settings& settings, std::uint16_t sequence,
                const Model& which = the_model()) {
  RecordBytes record{};
  write_record(which, settings, sequence, record);
  std::copy_n(record.begin(), record_size({record.data(), record.size()}),
              eeprom.cells.begin() + kCopies[copy]);
}

/// Stores a record with `length` bytes of settings, which may be more than this firmware supports.
inline void put_longer(FakeEeprom& eeprom, std::size_t copy, const Settings& settings, std::uint16_t sequence,
                       std::uint8_t length) {
  put(eeprom, copy, settings, sequence);
  lengthen(the_model(), eeprom.cells.data(), kCopies[copy], length);
}

inline void corrupt(FakeEeprom& eeprom, std::size_t copy) { eeprom.cells[kCopies[copy] + 5U] ^= 0x01U; }

/// Each function causes a different kind of failure: at least the next three attempts of a save fail.
inline const std::vector<void (*)(FakeEeprom&)> kFailures{
    [](FakeEeprom& eeprom) { eeprom.noisy_reads = kAttempts; },
    [](FakeEeprom& eeprom) { eeprom.failing_reads = kAttempts; },
    [](FakeEeprom& eeprom) { eeprom.unanswered_writes = kAttempts; },
    [](FakeEeprom& eeprom) {
      eeprom.unanswered_writes = kAttempts;
      eeprom.unanswered_but_done = true;
    },
    [](FakeEeprom& eeprom) { eeprom.stuck = true; },
};

}  // namespace ex9000
