// A simulated memory that can fail, and a settings store that uses this memory, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "firmware/settings/store.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000 {

using Found = SettingsStore::Found;

inline constexpr std::size_t kPage = 32;
inline constexpr std::size_t kAttempts = 3;
/// The number of reads that a store makes at reset if the memory never answers: three reads at the first
/// place, and one at the other.
inline constexpr std::size_t kReadsOfASilentMemory = kAttempts + 1;
/// An offset in a page. A record contains the module's address at this offset in its first page.
inline constexpr std::size_t kStuckCell = 4;

inline const Model& model(std::string_view designation) { return *find_model(designation); }

inline const Model& the_model() { return model("EX9042D-M"); }

inline Settings factory() { return Settings::factory(the_model()); }

/// Returns settings that differ for each `number` below 2,000,000.
inline Settings numbered(unsigned number) {
  Settings settings = factory();
  settings.address = static_cast<std::uint8_t>(1 + number % 247);
  settings.safe_value = static_cast<std::uint16_t>(number & 0x1FFFU);
  settings.watchdog_timeout = static_cast<std::uint8_t>(number * 7 + 1);
  return settings;
}

/// A memory of kStoredMemory bytes in pages of kPage bytes. Its public members determine how it fails, and
/// record what it has done.
class FakeMemory {
 public:
  enum class Garbage { None, Zeroes, Ones, MixedWithOld, MixedWithNew };
  static constexpr Garbage kEveryGarbage[] = {Garbage::None, Garbage::Zeroes, Garbage::Ones,
                                              Garbage::MixedWithOld, Garbage::MixedWithNew};

  /// Runs the job until it is done or the power fails. Returns whether the memory answered; no value if the
  /// power failed.
  std::optional<bool> run(const MemoryJob& job) {
    const bool writing = job.kind == MemoryJob::Kind::Write;
    const std::size_t size = job.bytes.size;
    EXPECT_NE(size, 0U);
    EXPECT_EQ(job.address / kPage, (job.address + size - 1) / kPage) << "a job crosses the end of a page";
    if (job.address + size > cells.size()) {
      ADD_FAILURE() << "a job goes beyond the end of the memory";
      return false;
    }
    return writing ? write(job) : read(job);
  }

  std::vector<std::uint8_t> cells = std::vector<std::uint8_t>(kStoredMemory, 0xFF);
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
  std::optional<bool> read(const MemoryJob& job) {
    reads.push_back(job.address);
    if (failing_reads > 0) {
      --failing_reads;
      return false;
    }
    std::copy_n(cells.begin() + job.address, job.bytes.size, job.bytes.data);
    if (noisy_reads > 0) {
      --noisy_reads;
      job.bytes.data[job.bytes.size / 2] ^= 0x10U;
    }
    return true;
  }

  std::optional<bool> write(const MemoryJob& job) {
    writes.push_back(job.address);
    const bool answers = unanswered_writes == 0;
    if (!answers) {
      --unanswered_writes;
      if (!unanswered_but_done) {
        return false;
      }
    }
    if (ignored_after == 0) {
      return answers;
    }
    if (ignored_after != SIZE_MAX) {
      --ignored_after;
    }
    for (std::size_t i = 0; i < job.bytes.size; ++i) {
      std::uint8_t& cell = cells[job.address + i];
      if (power && *power == 0) {
        cell = spoiled(cell, job.bytes.data[i]);
        return std::nullopt;
      }
      if (power) {
        --*power;
      }
      if (!stuck || (job.address + i) % kPage != kStuckCell) {
        cell = job.bytes.data[i];
      }
      ++bytes_written;
    }
    if (power && *power == 0) {
      return std::nullopt;  // all bytes of the job are written, but the firmware gets no answer
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
};

/// Runs all memory jobs of the store. Returns false if the power failed, or if the store is still busy after
/// 100 jobs, which is a failure of the test.
inline bool drive(SettingsStore& store, FakeMemory& memory) {
  for (int jobs = 0; store.busy(); ++jobs) {
    if (jobs == 100) {
      ADD_FAILURE() << "the store is still busy after 100 jobs";
      return false;
    }
    const MemoryJob job = store.job();
    const std::optional<bool> ok = memory.run(job);
    if (!ok) {
      return false;
    }
    store.done(*ok);
  }
  return true;
}

/// A module's settings store from one reset to the next.
class Boot {
 public:
  explicit Boot(FakeMemory& memory, const Model& which = the_model()) : memory_(memory), store_(which) {
    drive(store_, memory_);
  }
  /// Saves `settings`. Returns whether the store reported success; false if the power failed.
  bool save(const Settings& settings) {
    store_.begin_saving(settings);
    return drive(store_, memory_) && store_.saved();
  }
  [[nodiscard]] const Settings& stored() const { return store_.stored(); }
  [[nodiscard]] Found found() const { return store_.found(); }

 private:
  FakeMemory& memory_;
  SettingsStore store_;
};

/// The addresses of the two copies.
inline constexpr std::uint16_t kCopies[] = {0x000, 0x080};

inline void put(FakeMemory& memory, std::size_t copy, const Settings& settings, std::uint16_t sequence,
                const Model& which = the_model()) {
  RecordBytes record{};
  write_record(which, settings, sequence, record);
  std::copy_n(record.begin(), record_size({record.data(), record.size()}),
              memory.cells.begin() + kCopies[copy]);
}

/// Stores a record with `length` bytes of settings, which may be more than this firmware supports.
inline void put_longer(FakeMemory& memory, std::size_t copy, const Settings& settings, std::uint16_t sequence,
                       std::uint8_t length) {
  put(memory, copy, settings, sequence);
  lengthen(the_model(), memory.cells.data(), kCopies[copy], length);
}

inline void corrupt(FakeMemory& memory, std::size_t copy) { memory.cells[kCopies[copy] + 5U] ^= 0x01U; }

/// Each function causes a different kind of failure: at least the next three attempts of a save fail.
inline const std::vector<void (*)(FakeMemory&)> kFailures{
    [](FakeMemory& memory) { memory.noisy_reads = kAttempts; },
    [](FakeMemory& memory) { memory.failing_reads = kAttempts; },
    [](FakeMemory& memory) { memory.unanswered_writes = kAttempts; },
    [](FakeMemory& memory) {
      memory.unanswered_writes = kAttempts;
      memory.unanswered_but_done = true;
    },
    [](FakeMemory& memory) { memory.stuck = true; },
};

}  // namespace ex9000
