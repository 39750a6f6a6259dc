// The image slots in a NOR flash that also has the log of the settings.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "firmware/update/slot_job.hpp"
#include "hal/flash.hpp"
#include "hal/flash/log_hold.hpp"

namespace ex9000::hal::flash {

static_assert(update::kSector == kFlashSector);

/// In place of the log if the settings are in another memory.
template <class Flash>
class NoLog {
 public:
  /// As for RecordLog.
  static constexpr Duration kShortestErase = milliseconds(1);

  Flash& flash() { return flash_; }
  [[nodiscard]] static bool at_rest() { return true; }
  [[nodiscard]] static bool needs_flash() { return false; }
  static void hold(Hold /*hold*/) {}

 private:
  Flash flash_;
};

/// From address `kBegin` on. Functions: hal/image_slots.hpp; `Log`: RecordLog or NoLog.
///
/// An operation begins while the log is at rest, and then has the flash until it ends. If the log needs the
/// flash during an erase, the erase is suspended for it, so a job of the log waits for at most one program
/// operation, or kShortestErase. An erase makes progress even if the log writes all the time. Nothing ends a
/// job if the flash does not answer; the jobs of the log then fail.
template <class Log, std::uint32_t kBegin>
class ImageSlots {
  static_assert(kBegin % kFlashSector == 0, "kBegin: not the start of a sector");

 public:
  /// `log` must outlive this object.
  explicit constexpr ImageSlots(Log& log) : log_(log) {}

  /// Once, first, while the flash is not busy: reads the heads. `started`: the slot of the running image.
  void begin(unsigned started, std::string_view board) {
    origin_.slot = static_cast<std::uint8_t>(started);
    origin_.board = board;
    for (unsigned slot = 0; slot < update::kSlots; ++slot) {
      update::SlotHead& head = heads_[slot];
      log_.flash().read(address_of(slot, 0), {head.data(), head.size()});
      origin_.heads[slot] = {head.data(), head.size()};
    }
  }

  [[nodiscard]] const update::Origin& origin() const { return origin_; }

  void start(const update::SlotJob& job, Time /*now*/) {
    job_ = job;
    step_ = Step::Waiting;
  }

  bool poll(Time now) {
    switch (step_) {
      case Step::None:
        return false;
      case Step::Waiting:
        return log_.at_rest() && !log_.flash().busy() && begin_job(now);
      case Step::Programming:
        return !log_.flash().busy() && finish();
      case Step::Erasing:
        return log_.flash().busy() ? suspend_if_needed(now) : finish();
      case Step::Suspending:
        return finish_suspending(now);
      case Step::Suspended:
        resume_if_possible(now);
        return false;
    }
    return false;
  }

  [[nodiscard]] bool busy() const { return step_ != Step::None; }

 private:
  enum class Step : std::uint8_t {
    None,
    Waiting,  ///< for the log
    Programming,
    Erasing,
    Suspending,  ///< at most kLongestSuspend
    Suspended,   ///< the log has the flash
  };

  static constexpr Duration kLongestSuspend{20};  ///< us

  static constexpr std::uint32_t address_of(unsigned slot, std::uint32_t offset) {
    return kBegin + slot * update::kSlotSize + offset;
  }

  bool begin_job(Time now) {
    const std::uint32_t address = address_of(job_.slot, job_.offset);
    log_.hold(Hold::Everything);
    switch (job_.kind) {
      case update::SlotJob::Kind::Read:
        log_.flash().read(address, job_.destination);
        return finish();
      case update::SlotJob::Kind::Program:
        log_.flash().start_program(address, job_.source);
        step_ = Step::Programming;
        break;
      case update::SlotJob::Kind::Erase:
        log_.flash().start_erase(address);
        step_ = Step::Erasing;
        erase_changed_ = now;
        break;
    }
    return false;
  }

  bool finish() {
    log_.hold(Hold::Nothing);
    step_ = Step::None;
    return true;
  }

  bool suspend_if_needed(Time now) {
    if (!log_.needs_flash() || now.since(erase_changed_) < Log::kShortestErase) {
      return false;
    }
    log_.flash().suspend();
    step_ = Step::Suspending;
    erase_changed_ = now;
    return true;
  }

  bool finish_suspending(Time now) {
    if (log_.flash().busy()) {
      return now.since(erase_changed_) < kLongestSuspend;
    }
    log_.hold(Hold::Erases);
    step_ = Step::Suspended;
    return true;
  }

  /// If the erase ended before it could be suspended, the flash is then not busy.
  void resume_if_possible(Time now) {
    if (log_.needs_flash() || log_.flash().busy()) {
      return;
    }
    log_.hold(Hold::Everything);
    log_.flash().resume();
    step_ = Step::Erasing;
    erase_changed_ = now;
  }

  Log& log_;
  update::Origin origin_;
  std::array<update::SlotHead, update::kSlots> heads_{};
  update::SlotJob job_;
  Step step_ = Step::None;
  Time erase_changed_;  ///< when the erase began, or was suspended or resumed
};

}  // namespace ex9000::hal::flash
