// A memory of pages in a NOR flash.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "hal/flash.hpp"
#include "hal/flash/background_erase.hpp"
#include "hal/flash/entry.hpp"
#include "hal/flash/mark.hpp"
#include "hal/flash/sectors.hpp"
#include "hal/flash/slot.hpp"
#include "hal/flash/slot_map.hpp"
#include "hal/memory.hpp"

namespace ex9000::hal::flash {

/// A memory of 8 pages of 32 bytes in the 14 sectors from address `kBegin` on. For its functions, see
/// hal/memory.hpp; for `Flash`, see hal/flash.hpp. A page that was never written contains FF.
///
/// The sectors contain a log of entries. A write appends an entry with the whole page to the log, and reads
/// it back. For each page, the entry with the highest sequence is in force. If the power fails during a
/// write, the new entry is either complete or its CRC is wrong, so the page has its new or its old content.
/// No other entry in force changes.
///
/// The store never erases a sector that holds an entry in force. Therefore an erase cannot lose a page, and
/// the store need not copy entries before an erase. There is always a sector without an entry in force
/// (slot.hpp). The store begins to write to a sector only if the sector has a mark (mark.hpp). After a reset,
/// the first write begins a new sector, because a power failure may have interrupted the programming of a
/// slot whose bytes nevertheless read as FF.
///
/// While no job is running, `poll` erases all free sectors in advance. A free sector has neither a mark nor
/// an entry in force, has not failed (sectors.hpp), and is not the sector that is being written. A job
/// suspends the erase. The exception is a write that needs another sector while no erased sector is left: the
/// write waits for the end of an erase. A write waits in these cases:
///
/// - If the store has not erased a sector of this flash yet. The first erase takes 45 ms typically and 400 ms
///   at most.
/// - If the store uses sectors faster than it erases them. With the longest times of the data sheet, and
///   if no reset and no failure occurs, writes that are at least 12 ms apart never wait. If writes are closer
///   together, each sector that has been erased in advance has room for 79 writes.
///
/// With the longest times of the data sheet and a poll every millisecond, a read takes at most 5 ms, and a
/// write takes at most 14 ms if it does not wait for the end of an erase. Typically, a read takes 0 ms and a
/// write takes 1 ms. A read fails if it has not ended after kLongestRead. A write fails if it has not ended
/// after kLongestWrite. The first job after a reset also waits for the scan of the log, and it does not fail
/// during the scan. The scan reads at most 50 kB and computes at most about 1,100 CRCs.
///
/// The tests in tests/hal/flash measure these times, cut the power at each operation, and count erases.
template <class Flash, std::uint32_t kBegin>
class PageStore {
  static_assert(kIsFlash<Flash>,
                "Flash: lacks a function, or a function has a wrong signature; see hal/flash.hpp");
  static_assert(kBegin % kFlashSector == 0, "kBegin: not the start of a sector");

 public:
  /// The timeouts of jobs. If the memory does not answer, SettingsStore tries to read it six times after a
  /// reset, and the module must be ready to receive requests within 100 ms of the reset. For a command,
  /// SettingsStore tries at most six times to write to the memory if the memory contains no copy of an older
  /// layout, and the module must refuse the command within 200 ms.
  static constexpr Duration kLongestRead = milliseconds(12);
  static constexpr Duration kLongestWrite = milliseconds(25);

  Flash& flash() { return flash_; }

  void start_read(std::uint16_t address, MutableBytes destination, Time now) {
    destination_ = destination;
    begin(Job::Read, address, address + destination.size <= kSize, now + kLongestRead);
    poll(now);
  }

  void start_write(std::uint16_t address, Bytes source, Time now) {
    source_ = source;
    begin(Job::Write, address, address % kPage + source.size <= kPage && address < kSize,
          now + kLongestWrite);
    poll(now);
  }

  bool poll(Time now) {
    if (!busy() && step_ == Step::Free && !erases_ahead_) {
      return false;
    }
    const bool waits = flash_.busy();
    const bool again = waits ? wait(now) : proceed(now);
    if (busy() && (waits || !again) && deadline_.reached(now)) {
      waited_for_ = false;
      finish(false);
    }
    return again;
  }

  [[nodiscard]] bool busy() const { return job_ != Job::None; }
  [[nodiscard]] bool succeeded() const { return succeeded_; }

 private:
  enum class Job : std::uint8_t { None, Read, Write };
  enum class Step : std::uint8_t {
    Starting,  ///< ends an operation that was in progress at the reset
    Scanning,  ///< reads the log
    Free,      ///< can begin an operation, or an erase is running or suspended
    Opening,   ///< programs zeros over the mark of the sector that is written next
    Writing,   ///< programs an entry
    Marking,   ///< programs the mark of a sector that has been erased
  };

  /// A flash that is still busy after this time is erasing, because no program operation takes longer.
  static constexpr Duration kLongestProgram = milliseconds(4);
  static constexpr std::size_t kSize = kPages * kPage;

  static constexpr std::uint32_t address_of(Slot slot) { return kBegin + offset_of(slot); }

  /// Begins a job, or makes it fail immediately if it is not `possible`. A read is possible if all its bytes
  /// are in the store. A write is possible if all its bytes are in one page of the store.
  void begin(Job job, std::uint16_t address, bool possible, Time deadline) {
    job_ = job;
    address_ = address;
    deadline_.set(deadline);
    if (!possible) {
      finish(false);
    }
  }
  void finish(bool succeeded) {
    succeeded_ = succeeded;
    job_ = Job::None;
    deadline_.disarm();
  }

  // --- the steps ---
  // `wait`, `proceed` and `begin_job` return true if `poll` must be called again immediately.

  /// Runs a step while the flash is busy.
  bool wait(Time now) {
    if (step_ == Step::Starting) {
      return end_earlier_operation(now);
    }
    return step_ == Step::Free && can_begin_job() && erase_.suspend(flash_, now);
  }

  /// Runs a step while the flash is not busy.
  bool proceed(Time now) {
    switch (step_) {  // not covered: the cases are complete
      case Step::Starting:
        erase_.suspend_unknown(flash_, Sectors::kNone);
        step_ = Step::Scanning;
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
      case Step::Marking:
        finish_marking();
        return true;
      case Step::Free:
        break;
    }
    if (erase_.take_end() && erase_.sector() != Sectors::kNone) {
      program(Step::Marking, first_slot(erase_.sector()), {kMark.data(), kMark.size()});
      return false;
    }
    if (can_begin_job()) {
      return begin_job();
    }
    erase_ahead(now);
    return false;
  }

  /// Returns whether a job is running and its next operation can begin. A write must wait for an erase if it
  /// needs another sector and no erased sector is left.
  [[nodiscard]] bool can_begin_job() const {
    return job_ == Job::Read ||
           (job_ == Job::Write && (next_ != kNoSlot || sectors_.next_to_open() != Sectors::kNone));
  }

  bool begin_job() {
    if (job_ == Job::Read) {
      read_pages();
      return erases_ahead_;
    }
    if (next_ == kNoSlot) {
      opening_ = sectors_.next_to_open();
      program(Step::Opening, first_slot(opening_), {kNoMark.data(), kNoMark.size()});
    } else {
      begin_writing();
    }
    return false;
  }

  void program(Step step, Slot slot, Bytes bytes) {
    flash_.start_program(address_of(slot), bytes);
    step_ = step;
  }

  // --- start ---

  /// Waits for the end of an operation that was in progress when the MCU was reset without loss of power. If
  /// the flash is still busy after kLongestProgram, it is erasing. This function then suspends the erase and
  /// returns true.
  bool end_earlier_operation(Time now) {
    if (!program_end_.armed()) {
      program_end_.set(now + kLongestProgram);
    }
    if (!program_end_.reached(now)) {
      return false;
    }
    erase_.suspend_unknown(flash_, Sectors::kNone);
    step_ = Step::Scanning;
    return true;
  }

  /// Scans the slots in one page of the flash, or records that a sector has its mark and skips the sector.
  void scan() {
    const Slot end = static_cast<Slot>(scanned_ + kSlotsOfAFlashPage);
    for (; scanned_ < end; ++scanned_) {
      if (!is_for_mark(scanned_)) {
        scan_entry(scanned_);
      } else if (has_mark(sector_of(scanned_))) {
        sectors_.set(sector_of(scanned_), Sectors::State::Erased);
        scanned_ = static_cast<Slot>(scanned_ + kSlotsOfASector);
        break;
      }
    }
    if (scanned_ == kSlots) {
      step_ = Step::Free;
      erases_ahead_ = true;
    }
  }

  void scan_entry(Slot slot) {
    if (!read_entry(slot)) {
      return;
    }
    const std::uint32_t sequence = sequence_of(entry_);
    map_.add(entry_[kPageAt], sequence, slot);
    if (sequence >= sequence_) {
      sequence_ = sequence + 1;
      sectors_.begin_after(sector_of(slot));
    }
  }

  // --- reading ---

  /// Reads the slot into `entry_`. Returns whether the slot contains a good entry.
  bool read_entry(Slot slot) {
    flash_.read(address_of(slot), {entry_.data(), entry_.size()});
    return is_good(entry_);
  }

  bool has_mark(unsigned sector) {
    MarkBytes mark{};
    flash_.read(address_of(first_slot(sector)), {mark.data(), mark.size()});
    return mark == kMark;
  }

  /// Reads the newest entry of a page into `entry_`. If the page has no entry, or if the entry is damaged,
  /// fills `entry_` with FF. Returns false only if the entry is damaged.
  bool load_page(std::size_t page) {
    const Slot slot = map_.newest(page);
    if (slot != kNoSlot && read_entry(slot)) {
      return true;
    }
    entry_.fill(0xFF);
    return slot == kNoSlot;
  }

  void read_pages() {
    bool good = true;
    for (std::size_t i = 0; i < destination_.size; ++i) {
      const std::size_t at = address_ + i;
      if (i == 0 || at % kPage == 0) {
        good = load_page(at / kPage) && good;
      }
      destination_.data[i] = entry_[kContentAt + at % kPage];
    }
    finish(good);
  }

  // --- writing ---

  void begin_writing() {
    const std::size_t page = address_ / kPage;
    (void)load_page(page);  // if its entry is damaged, the bytes that are not written become FF
    for (std::size_t i = 0; i < source_.size; ++i) {
      entry_[kContentAt + address_ % kPage + i] = source_[i];
    }
    seal(entry_, sequence_, page);
    program(Step::Writing, next_, {entry_.data(), entry_.size()});
    waited_for_ = true;
  }

  void finish_opening() {
    step_ = Step::Free;
    if (has_mark(opening_)) {
      sectors_.set(opening_, Sectors::State::Failed);
      return;
    }
    sectors_.open(opening_);
    next_ = static_cast<Slot>(first_slot(opening_) + 1U);
  }

  void finish_writing() {
    step_ = Step::Free;
    const EntryBytes written = entry_;
    const bool good = read_entry(next_) && entry_ == written;
    if (good) {
      map_.add(entry_[kPageAt], sequence_, next_);
    }
    ++sequence_;
    next_ = good ? next_slot(next_) : kNoSlot;  // if not good, the sector is erased before its next use
    erases_ahead_ = true;
    if (waited_for_) {
      waited_for_ = false;
      finish(good);
    }
  }

  // --- erasing in advance ---

  void erase_ahead(Time now) {
    if (erase_.suspended()) {
      erase_.resume(flash_, now);
      return;
    }
    const unsigned sector =
        sectors_.next_to_erase(map_, next_ == kNoSlot ? Sectors::kNone : sector_of(next_));
    erases_ahead_ = sector != Sectors::kNone;
    if (erases_ahead_) {
      erase_.start(flash_, sector, address_of(first_slot(sector)), now);
    }
  }

  void finish_marking() {
    step_ = Step::Free;
    const unsigned sector = erase_.sector();
    sectors_.set(sector, has_mark(sector) ? Sectors::State::Erased : Sectors::State::Failed);
  }

  Flash flash_;
  Job job_ = Job::None;
  Step step_ = Step::Starting;
  bool succeeded_ = false;
  bool waited_for_ = false;    ///< the job waits for the entry that is being programmed
  bool erases_ahead_ = true;   ///< `poll` is erasing a sector, or must check whether one must be erased
  std::uint16_t address_ = 0;  ///< address of the job
  Bytes source_;
  MutableBytes destination_;
  Deadline deadline_;     ///< timeout of the job
  Deadline program_end_;  ///< latest end of a program operation that was in progress at the reset
  BackgroundErase<Flash> erase_;
  Sectors sectors_;
  SlotMap map_;
  std::uint32_t sequence_ = 1;  ///< sequence of the next entry
  Slot next_ = kNoSlot;         ///< slot of the next entry; kNoSlot if it must go to another sector
  unsigned opening_ = 0;
  Slot scanned_ = 0;  ///< the slots before this one have been scanned
  EntryBytes entry_{};
};

}  // namespace ex9000::hal::flash
