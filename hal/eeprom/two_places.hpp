// The record of the settings in an EEPROM.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/time.hpp"
#include "hal/eeprom.hpp"
#include "hal/memory.hpp"

namespace ex9000::hal {

/// Each place begins at the start of a page.
inline constexpr std::array<std::uint16_t, 2> kPlaces{0x0000, 0x0080};
static_assert(kPlaces[0] + kRecordRoom <= kPlaces[1], "a record does not fit in its place");

/// All FF, as if never written.
constexpr bool is_blank(Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != 0xFF) {
      return false;
    }
  }
  return true;
}

/// Up to two records, each in its place; functions: hal/memory.hpp, hal/eeprom.hpp (`Eeprom`). A save goes to
/// the place without the newest record, page by page, and reads each page back. The new record becomes good
/// only with the check at its end.
///
/// A load reads each place up to three times, until its record is good or its first page, and so the place,
/// is blank. If the last read at the first place and one at the second get no answer, the latter is not
/// repeated: a module must be ready 100 ms after a reset.
template <class Eeprom>
class TwoPlaces {
 public:
  constexpr TwoPlaces() = default;
  explicit constexpr TwoPlaces(Eeprom eeprom) : eeprom_(eeprom) {}
  Eeprom& eeprom() { return eeprom_; }

  void start(const MemoryJob& job, Time /*now*/) {
    job_ = job;
    step_ = Step::Start;
  }

  bool poll(Time now) {
    const bool again = eeprom_.poll(now);
    if (!busy() || eeprom_.busy()) {
      return again;
    }
    next(eeprom_.succeeded());
    if (busy()) {
      access(now);
    }
    return again || (busy() && !eeprom_.busy());
  }

  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  [[nodiscard]] MemoryResult result() const {
    const bool refused = refused_ != kNoPlace;
    const bool known = !unread_ && found_ != SettingsSource::NoneGood;
    return {succeeded_, found_, known && !refused, refused};
  }

 private:
  enum class Step : std::uint8_t { Idle, Start, Load, Write, Verify, Withdraw, CheckWithdrawn };
  static constexpr std::size_t kNoPlace = kPlaces.size();
  static constexpr std::uint8_t kReads = 3;

  void begin_job() {
    switch (job_.kind) {
      case MemoryJob::Kind::Load:
        newest_ = kNoPlace;
        bad_ = unread_ = silent_ = false;
        load(0);
        break;
      case MemoryJob::Kind::Save:
        write(Step::Write, newest_ == 0 ? 1 : 0, {job_.record.data, job_.record.size});
        break;
      case MemoryJob::Kind::Withdraw:
        withdraw();
        break;
    }
  }

  // --- accesses; each step ends when its access has ended ---

  void load(std::size_t place) {
    place_ = place;
    job_.attempts = kReads;
    begin(Step::Load, kEepromPage);  // `end_read` sets the size of a record
  }
  void write(Step step, std::size_t place, Bytes source) {
    place_ = place;
    source_ = source;
    begin(step, source.size);
  }
  void withdraw() { write(Step::Withdraw, refused_, {kNoRecord.data(), kNoRecord.size()}); }
  void begin(Step step, std::size_t size) {
    step_ = step;
    done_ = 0;
    size_ = size;
  }

  /// Of the access at `done_`: to the end of the page or of the record.
  [[nodiscard]] std::size_t page() const {
    const std::size_t left = size_ - done_;
    return left < kEepromPage ? left : kEepromPage;
  }

  void access(Time now) {
    const auto address = static_cast<std::uint16_t>(kPlaces[place_] + done_);
    if (step_ == Step::Write || step_ == Step::Withdraw) {
      eeprom_.start_write(address, {source_.data + done_, page()}, now);
    } else {
      eeprom_.start_read(address, {buffer_.data() + done_, page()}, now);
    }
  }

  /// After an access; `ok`: it succeeded. In `poll`, the compiler would repeat the EEPROM's driver each time.
  [[gnu::noinline]] void next(bool ok) {
    switch (step_) {
      case Step::Start:
        begin_job();
        break;
      case Step::Load:
        end_read(ok);
        break;
      case Step::Write:
        if (ok) {
          step_ = Step::Verify;
        } else {
          fail();
        }
        break;
      case Step::Verify:
        verify(ok);
        break;
      case Step::Withdraw:
        // Read back, because the memory may acknowledge a write without effect.
        step_ = ok ? Step::CheckWithdrawn : Step::Idle;
        succeeded_ = false;
        break;
      case Step::CheckWithdrawn:
        refused_ = ok && !counts() ? kNoPlace : refused_;
        finish(false);
        break;
      case Step::Idle:  // not covered: no access is running while idle
        break;
    }
  }

  void finish(bool succeeded) {
    step_ = Step::Idle;
    succeeded_ = succeeded;
  }

  /// A record with the header in `buffer_` could be newer than the newest one.
  [[nodiscard]] bool counts() const {
    const Bytes header{buffer_.data(), buffer_.size()};
    return record_size(header) != 0 && (newest_ == kNoPlace || is_later(sequence_of(header), sequence_));
  }

  // --- loading ---

  void end_read(bool ok) {
    done_ += ok ? page() : 0;
    size_ = record_size({buffer_.data(), kEepromPage});
    if (ok && done_ < size_) {
      return;
    }
    const Bytes read{buffer_.data(), done_};
    const bool blank = ok && is_blank(read.first(kEepromPage));
    const bool good = ok && place_ != refused_ && read_record(*job_.model, read).has_value();
    const bool try_again = --job_.attempts != 0 && (ok || !silent_);
    if (!good && !blank && try_again) {
      begin(Step::Load, kEepromPage);
      return;
    }
    silent_ = !ok;
    unread_ = unread_ || !ok;
    bad_ = bad_ || (!blank && !good);
    if (good && counts()) {
      newest_ = place_;
      sequence_ = sequence_of(read);
      for (std::size_t i = 0; i < read.size; ++i) {
        job_.record.data[i] = read[i];
      }
    }
    if (place_ + 1 < kPlaces.size()) {
      load(place_ + 1);
    } else {
      finish_load();
    }
  }

  void finish_load() {
    if (newest_ != kNoPlace) {
      found_ = bad_ ? SettingsSource::OneCopyBad : SettingsSource::Good;
    } else {
      found_ = bad_ ? SettingsSource::NoneGood : SettingsSource::Blank;
    }
    finish(!unread_);
  }

  // --- saving ---

  void verify(bool ok) {
    const Bytes written = source_.from(done_).first(page());
    if (!ok || !std::equal(written.begin(), written.end(), buffer_.data() + done_)) {
      fail();
      return;
    }
    done_ += page();
    if (done_ < size_) {
      step_ = Step::Write;
      return;
    }
    newest_ = place_;
    sequence_ = sequence_of(source_);
    found_ = SettingsSource::Good;
    unread_ = false;
    refused_ = kNoPlace;
    finish(true);
  }

  void fail() {
    if (--job_.attempts != 0) {
      step_ = Step::Write;
      return;
    }
    refused_ = place_;  // the record may be complete although the memory reported an error
    withdraw();
  }

  Eeprom eeprom_{};
  MemoryJob job_;  ///< `attempts` counts those that are left
  Bytes source_;   ///< the bytes to write at the place
  Step step_ = Step::Idle;
  SettingsSource found_ = SettingsSource::NoneGood;  ///< see MemoryResult::source
  bool succeeded_ = false;
  bool silent_ = false;  ///< the last read at the first place got no answer
  bool unread_ = false;  ///< a place did not answer, and its record may be newer than the newest one
  bool bad_ = false;     ///< a place is not blank and has no good record

  std::size_t place_ = 0;           ///< the place that is being read or written
  std::size_t done_ = 0;            ///< bytes at this place that have been processed
  std::size_t size_ = 0;            ///< bytes to process there
  std::size_t newest_ = kNoPlace;   ///< the place of the newest good record
  std::size_t refused_ = kNoPlace;  ///< the place of a record of a failed save that may still count
  std::uint16_t sequence_ = 0;      ///< of the newest good record
  RecordBytes buffer_{};            ///< bytes read
};

}  // namespace ex9000::hal
