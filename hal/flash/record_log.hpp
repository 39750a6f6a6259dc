// The record of the settings in a NOR flash.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/time.hpp"
#include "hal/flash.hpp"
#include "hal/flash/log_hold.hpp"
#include "hal/memory.hpp"

namespace ex9000::hal::flash {

/// They form a ring and are used in this order, so that they wear evenly.
inline constexpr unsigned kSectors = 14;
/// Each has room for a record and crosses no end of a page. The first place of a sector is for its mark.
inline constexpr unsigned kPlacesOfASector = kFlashSector / kRecordRoom;
inline constexpr unsigned kPlaces = kSectors * kPlacesOfASector;
static_assert(kFlashPage % kRecordRoom == 0);

/// Begins an erased, unused sector; programmed when the erase has ended. An interrupted erase may leave bytes
/// that read as FF but do not keep what is programmed into them, so a sector without this mark is erased
/// before use. The value is arbitrary.
inline constexpr std::array<std::uint8_t, 8> kMark{0x45, 0x58, 0x39, 0xC6, 0xA7, 0x9B, 0x53, 0x1D};
/// Programmed over the mark before the sector is used: the mark is gone before the next erase begins, and an
/// interrupted erase does not restore it.
inline constexpr std::array<std::uint8_t, 8> kNoMark{};

/// Records in the sectors from address `kBegin` on. Functions: hal/memory.hpp; `Flash`: hal/flash.hpp.
///
/// A save appends a record and reads it back. The newest good record is in force, so a power failure leaves
/// the previous record or the new one. The log begins to write only in a sector with a mark. It takes a new
/// one after a failed attempt and for the first save after a reset: the power may have failed while a place
/// was programmed whose bytes still read as FF.
///
/// Between jobs, `poll` erases ahead all free sectors: no mark, no record in force, not being written, not
/// failed. A job suspends the erase. Nothing is erased while no record is in force but the flash holds bad
/// ones, for example of another model. A save waits for the end of an erase:
/// - If the log has not erased a sector of this flash yet: typically 45 ms, at most 400 ms.
/// - If it uses sectors faster than it erases them. With the longest times of the data sheet and no reset or
///   failure, saves at least 18 ms apart never wait. Closer ones have 31 places per sector erased ahead.
///
/// With those times and a poll every millisecond, a save that does not wait or fail takes at most 8 ms,
/// typically 1 ms. A load reads at most 58 kB and checks at most 434 records. It suspends an erase that a
/// reset has interrupted and reads that sector too, because it cannot know which one it is; that holds
/// neither a mark nor the record in force. A load fails if the flash does not answer within kLongestLoad, a
/// save if it has not ended after kLongestSave. The tests in tests/hal measure these times, cut the power at
/// each operation, and count erases.
template <class Flash, std::uint32_t kBegin>
class RecordLog {
  static_assert(kBegin % kFlashSector == 0, "kBegin: not the start of a sector");

 public:
  /// A module must be ready within 100 ms of a reset, and refuse a command within 200 ms, even if a save
  /// without a command and a load come first.
  static constexpr Duration kLongestLoad = milliseconds(40);
  static constexpr Duration kLongestSave = milliseconds(60);
  /// An erase runs at least this long before it is suspended, so that it makes progress: a W25Q16JV requires
  /// 20 us, other chips up to 1 ms.
  static constexpr Duration kShortestErase = milliseconds(1);

  Flash& flash() { return flash_; }

  void start(const MemoryJob& job, Time now) {
    job_ = job;
    busy_ = true;
    deadline_.set(now + (job.kind == MemoryJob::Kind::Load ? kLongestLoad : kLongestSave));
  }

  bool poll(Time now) {
    if (at_rest()) {
      return false;
    }
    const bool waits = held_ == Hold::Everything || flash_.busy();
    const bool again = waits ? wait(now) : proceed(now);
    if (busy() && (waits || !again) && deadline_.reached(now)) {
      give_up();
    }
    return again;
  }

  // --- for another user of the flash (hal/flash/image_slots.hpp) ---

  /// No job, no operation, and no sector to erase.
  [[nodiscard]] bool at_rest() const { return !busy_ && step_ == Step::Free && !erases_ahead_; }
  /// An operation of the log is running, or it can begin its job. A job that waits for an erased sector does
  /// not need the flash as long as erases are held.
  [[nodiscard]] bool needs_flash() const { return step_ != Step::Free || can_begin_job(); }
  /// Other than `Nothing` only from a rest on.
  void hold(Hold hold) { held_ = hold; }

  [[nodiscard]] bool busy() const { return busy_; }
  [[nodiscard]] MemoryResult result() const {
    const bool known = result_.source != SettingsSource::NoneGood;
    return {result_.succeeded, result_.source, known && refused_ == kNoPlace, refused_ != kNoPlace};
  }

 private:
  using Kind = MemoryJob::Kind;
  enum class Step : std::uint8_t {
    Starting,     ///< ends an operation that was in progress at the reset
    Free,         ///< can begin an operation, or an erase is running or suspended
    Scanning,     ///< reads the log
    Opening,      ///< programs zeros over the mark of the sector that is written next
    Writing,      ///< programs a record
    Withdrawing,  ///< programs zeros over the beginning of a record
    Marking,      ///< programs the mark of a sector that has been erased
  };

  enum class Erase : std::uint8_t { None, Running, Suspended };

  /// If still busy after this, the flash is erasing: no program operation takes longer.
  static constexpr Duration kLongestProgram = milliseconds(4);
  static constexpr unsigned kNoPlace = kPlaces;
  static constexpr unsigned kNoSector = kSectors;

  static constexpr unsigned sector_of(unsigned place) { return place / kPlacesOfASector; }
  static constexpr bool is_for_mark(unsigned place) { return place % kPlacesOfASector == 0; }
  static constexpr unsigned mark_of(unsigned sector) { return sector * kPlacesOfASector; }
  static constexpr std::uint16_t bit(unsigned sector) { return static_cast<std::uint16_t>(1U << sector); }

  void finish(bool succeeded) {
    result_.succeeded = succeeded;
    busy_ = false;
    deadline_.disarm();
  }
  /// The time of the job is over. The flash may still complete its operation.
  void give_up() {
    if (step_ == Step::Writing && next_ != kNoPlace) {
      refused_ = next_;
      next_ = kNoPlace;
    }
    finish(false);
  }

  // --- the steps ---

  /// True: call `poll` again at once. `wait` is for a flash that is busy, `proceed` for one that is not.
  bool wait(Time now) {
    if (step_ == Step::Starting) {
      return end_earlier_operation(now);
    }
    const bool too_early = erase_ == Erase::Running && now.since(erase_began_) < kShortestErase;
    if (step_ != Step::Free || !can_begin_job() || too_early) {
      return false;
    }
    if (erase_ == Erase::Running) {
      suspend_erase();
    }
    return erase_ == Erase::Suspended;
  }

  bool proceed(Time now) {
    const Step step = step_;
    step_ = step == Step::Scanning ? step : Step::Free;
    switch (step) {
      case Step::Starting:
        suspend_erase();
        return true;
      case Step::Scanning:
        scan();
        return true;
      case Step::Opening:
        finish_opening();
        return true;
      case Step::Writing:
        finish_writing();
        return true;
      case Step::Withdrawing:
        finish_withdrawing();
        return true;
      case Step::Marking:
        finish_marking();
        return true;
      case Step::Free:
        break;
    }
    if (erase_ == Erase::Running) {
      erase_ = Erase::None;
      if (erasing_ != kNoSector) {
        program(Step::Marking, mark_of(erasing_), {kMark.data(), kMark.size()});
        return false;
      }
    }
    if (can_begin_job()) {
      begin_job();
      return step_ == Step::Scanning;
    }
    erase_ahead(now);
    return false;
  }

  /// After a reset without loss of power. A flash still busy after kLongestProgram is erasing: suspend it.
  bool end_earlier_operation(Time now) {
    if (!program_end_.armed()) {
      program_end_.set(now + kLongestProgram);
    }
    if (!program_end_.reached(now)) {
      return false;
    }
    step_ = Step::Free;
    suspend_erase();
    return true;
  }

  /// A save must wait for an erase if it needs another sector and no erased one is left.
  [[nodiscard]] bool can_begin_job() const {
    return busy_ && (job_.kind != Kind::Save || refused_ != kNoPlace || next_ != kNoPlace ||
                     next_erased() != kNoSector);
  }

  void begin_job() {
    if (job_.kind == Kind::Load) {
      begin_scan();
    } else if (refused_ != kNoPlace) {
      program(Step::Withdrawing, refused_, {kNoRecord.data(), kNoRecord.size()});
    } else if (job_.kind == Kind::Withdraw) {
      finish(true);  // the record was withdrawn after its job had ended
    } else if (next_ == kNoPlace) {
      opening_ = next_erased();
      program(Step::Opening, mark_of(opening_), {kNoMark.data(), kNoMark.size()});
    } else {
      program(Step::Writing, next_, {job_.record.data, job_.record.size});
    }
  }

  // --- access to the flash ---

  static constexpr std::uint32_t address_of(unsigned place) { return kBegin + place * kRecordRoom; }

  void program(Step step, unsigned place, Bytes bytes) {
    flash_.start_program(address_of(place), bytes);
    step_ = step;
  }
  Bytes read(unsigned place, std::size_t size) {
    flash_.read(address_of(place), {buffer_.data(), size});
    return {buffer_.data(), size};
  }
  bool has_mark(unsigned sector) {
    const Bytes mark = read(mark_of(sector), kMark.size());
    return std::equal(mark.begin(), mark.end(), kMark.begin());
  }

  // --- loading ---

  void begin_scan() {
    newest_ = kNoPlace;
    bad_ = false;
    scanned_ = 0;
    step_ = Step::Scanning;
  }

  /// A place; or a sector with its mark, which is skipped.
  void scan() {
    if (!is_for_mark(scanned_)) {
      scan_record(scanned_);
    } else if (has_mark(sector_of(scanned_))) {
      erased_ |= bit(sector_of(scanned_));
      scanned_ += kPlacesOfASector - 1;
    }
    if (++scanned_ == kPlaces) {
      finish_load();
    }
  }

  void scan_record(unsigned place) {
    const std::size_t size = record_size(read(place, kHeaderSize));
    if (size == 0) {
      return;
    }
    const Bytes record = read(place, size);
    if (place == refused_ || !read_record(*job_.model, record)) {
      bad_ = bad_ || newest_ == kNoPlace || sector_of(newest_) == sector_of(place);
    } else if (counts(record)) {
      take(record, place);
      bad_ = false;
      for (std::size_t i = 0; i < size; ++i) {
        job_.record.data[i] = record[i];
      }
    }
  }

  void finish_load() {
    step_ = Step::Free;
    if (newest_ != kNoPlace) {
      result_.source = bad_ ? SettingsSource::OneCopyBad : SettingsSource::Good;
      last_ = sector_of(newest_);
    } else {
      result_.source = bad_ ? SettingsSource::NoneGood : SettingsSource::Blank;
    }
    may_erase();
    finish(true);
  }

  /// `record` begins a record that could be newer than the newest one.
  [[nodiscard]] bool counts(Bytes record) const {
    return record_size(record) != 0 && (newest_ == kNoPlace || is_later(sequence_of(record), sequence_));
  }
  void take(Bytes record, unsigned place) {
    newest_ = place;
    sequence_ = sequence_of(record);
  }

  // --- saving ---

  void finish_opening() {
    erased_ &= static_cast<std::uint16_t>(~bit(opening_));
    if (has_mark(opening_)) {
      failed_ |= bit(opening_);
      return;
    }
    last_ = opening_;
    next_ = mark_of(opening_) + 1;
  }

  void finish_writing() {
    const unsigned place = next_;
    if (place == kNoPlace) {
      return;  // the job has been given up
    }
    const Bytes written = read(place, job_.record.size);
    const bool good = std::equal(written.begin(), written.end(), job_.record.data);
    next_ = good && !is_for_mark(place + 1) ? place + 1 : kNoPlace;
    if (good) {
      take(written, place);
      result_.source = SettingsSource::Good;
      finish(true);
    } else {
      refused_ = place;  // `begin_job` withdraws the record before it tries again
      --job_.attempts;
    }
    may_erase();
  }

  void finish_withdrawing() {
    if (!counts(read(refused_, kHeaderSize))) {
      refused_ = kNoPlace;
    }
    if (job_.kind == Kind::Withdraw || refused_ != kNoPlace || job_.attempts == 0) {
      finish(false);
    }
  }

  // --- erasing in advance ---

  /// In the ring, from the sector after the one opened last; kNoSector if none is suitable.
  template <class IsSuitable>
  [[nodiscard]] unsigned first_sector(IsSuitable is_suitable) const {
    for (unsigned i = 1; i <= kSectors; ++i) {
      const unsigned sector = (last_ + i) % kSectors;
      if (is_suitable(sector)) {
        return sector;
      }
    }
    return kNoSector;
  }
  [[nodiscard]] unsigned next_erased() const {
    return first_sector([this](unsigned sector) { return (erased_ & bit(sector)) != 0; });
  }

  /// `poll` looks for free sectors, unless the flash holds bad records and none in force. An erase of before
  /// the reset ends in any case.
  void may_erase() {
    erases_ahead_ = result_.source != SettingsSource::NoneGood || erase_ == Erase::Suspended;
  }

  void erase_ahead(Time now) {
    if (held_ != Hold::Nothing) {
      return;
    }
    erase_began_ = now;
    if (erase_ == Erase::Suspended) {
      erase_ = Erase::Running;
      flash_.resume();
      return;
    }
    if (!busy() && result_.source == SettingsSource::NoneGood) {
      erases_ahead_ = false;
      return;
    }
    erasing_ = first_sector([this](unsigned each) {
      return ((erased_ | failed_) & bit(each)) == 0 && each != sector_of(newest_) &&
             each != sector_of(next_) && each != sector_of(refused_);
    });
    erases_ahead_ = erasing_ != kNoSector;
    if (erases_ahead_) {
      erase_ = Erase::Running;
      flash_.start_erase(address_of(mark_of(erasing_)));
    }
  }

  /// Available within 20 us. No effect if the erase has just ended or there was none at the reset.
  void suspend_erase() {
    erase_ = Erase::Suspended;
    flash_.suspend();
  }

  void finish_marking() { (has_mark(erasing_) ? erased_ : failed_) |= bit(erasing_); }

  Flash flash_;
  MemoryJob job_;  ///< `attempts` counts those that are left
  bool busy_ = false;
  Hold held_ = Hold::Nothing;
  Step step_ = Step::Starting;
  MemoryResult result_;
  bool erases_ahead_ = false;  ///< `poll` is erasing a sector, or must check whether one must be erased
  bool bad_ = false;           ///< a record that may have been newer than the newest good one is bad
  Deadline deadline_;          ///< timeout of the job
  Deadline program_end_;       ///< latest end of a program operation that was in progress at the reset
  Erase erase_ = Erase::None;
  unsigned erasing_ = kNoSector;  ///< sector of the last erase; kNoSector: erase of before the reset
  Time erase_began_;              ///< when it began or was resumed

  unsigned newest_ = kNoPlace;   ///< place of the record in force
  std::uint16_t sequence_ = 0;   ///< of the record in force
  unsigned refused_ = kNoPlace;  ///< place of a record of a failed save that may still count
  unsigned next_ = kNoPlace;     ///< place of the next record; kNoPlace if it must go to another sector
  unsigned scanned_ = 0;         ///< the places before this one have been scanned
  unsigned opening_ = 0;
  unsigned last_ = kSectors - 1;  ///< the sector that was opened last
  std::uint16_t erased_ = 0;      ///< bit n: sector n is erased and has its mark
  std::uint16_t failed_ = 0;      ///< bit n: the mark of sector n cannot be programmed or cleared
  RecordBytes buffer_{};          ///< bytes read
};

}  // namespace ex9000::hal::flash
