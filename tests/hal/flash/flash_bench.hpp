// A module's settings in a log on the model of a flash, from one reset to the next.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

#include "firmware/settings/settings_keeper.hpp"
#include "hal/flash/record_log.hpp"
#include "hal/memory.hpp"
#include "tests/hal/flash/flash_chip.hpp"
#include "tests/hal/numbered_settings.hpp"

namespace ex9000::hal::flash {

/// Passes the calls of the log to a chip, which must outlive the log.
struct FlashPort {
  FlashChip* chip = nullptr;

  void start_erase(std::uint32_t address) const { chip->start_erase(address); }
  void start_program(std::uint32_t address, Bytes source) const { chip->start_program(address, source); }
  [[nodiscard]] bool busy() const { return chip->busy(); }
  void suspend() const { chip->suspend(); }
  void resume() const { chip->resume(); }
  void read(std::uint32_t address, MutableBytes destination) const { chip->read(address, destination); }
};

using Log = RecordLog<FlashPort, FlashChip::kBegin>;

/// A log with its main loop.
class OnFlash {
 public:
  /// Begins as a reset does, and loads the settings. `chip` must outlive this object.
  explicit OnFlash(FlashChip& chip, const Model& which = the_model()) : chip_(&chip), keeper_(which) {
    log_.flash().chip = &chip;
    latency = drive();
  }
  /// Continues with a copy of `other`. `chip` is a copy of the chip of `other`.
  OnFlash(FlashChip& chip, const OnFlash& other) : OnFlash(other) {
    chip_ = &chip;
    log_.flash().chip = &chip;
  }
  OnFlash(const OnFlash&) = default;
  OnFlash& operator=(const OnFlash&) = delete;

  /// Saves `settings` as for a command. Returns whether the save succeeded.
  bool save(const Settings& settings) {
    keeper_.save(settings, chip_->time());
    latency = drive();
    return keeper_.saved();
  }
  /// Begins to save `settings`. Then call `run` or `Log::poll`, and `end_save`.
  void begin_save(const Settings& settings) {
    keeper_.save(settings, chip_->time());
    log_.start(keeper_.job(), chip_->time());
  }
  /// Runs the main loop until the save has ended. Returns whether it succeeded.
  bool end_save() {
    while (log_.busy()) {
      turn();
    }
    keeper_.done(log_.result());
    return keeper_.saved();
  }
  /// Runs the main loop for at least `microseconds` without a command, while `stored()` is in force.
  void idle(std::uint64_t microseconds) {
    for (const std::uint64_t end = chip_->now + microseconds; chip_->now < end;) {
      keeper_.poll(keeper_.stored(), chip_->time());
      drive();
      turn();
    }
  }
  /// Runs the main loop until all free sectors are erased.
  void settle() {
    constexpr int kQuietTurns = 6;
    for (int quiet = 0; quiet < kQuietTurns; ++quiet) {
      turn();
      if (chip_->busy() || chip_->erase_suspended()) {
        quiet = 0;
      }
    }
  }
  /// Runs the main loop for `microseconds`, in steps of at most kMemoryPollPeriod.
  void run(std::uint64_t microseconds) {
    for (const std::uint64_t end = chip_->now + microseconds; chip_->now < end;) {
      poll();
      chip_->run(std::min<std::uint64_t>(kMemoryPollPeriod.microseconds(), end - chip_->now));
    }
  }

  [[nodiscard]] const Settings& stored() const { return keeper_.stored(); }
  [[nodiscard]] SettingsSource source() const { return keeper_.source(); }
  SettingsKeeper& keeper() { return keeper_; }
  Log& log() { return log_; }
  std::uint64_t latency = 0;  ///< duration of the last load or save in us

 private:
  /// Runs all jobs of the keeper. Returns their duration in us. Fails the test if it exceeds 1 s.
  std::uint64_t drive() {
    const std::uint64_t began = chip_->now;
    while (keeper_.busy()) {
      for (log_.start(keeper_.job(), chip_->time()); log_.busy(); turn()) {
        if (chip_->now - began > 1'000'000) {
          ADD_FAILURE() << "the job does not end";
          return chip_->now - began;
        }
      }
      keeper_.done(log_.result());
    }
    return chip_->now - began;
  }
  /// Calls `poll` every 10 us until it returns false.
  void poll() {
    constexpr std::uint64_t kTurn = 10;
    while (log_.poll(chip_->time())) {
      chip_->run(kTurn);
    }
  }
  void turn() {
    poll();
    chip_->run(kMemoryPollPeriod.microseconds());
  }

  FlashChip* chip_;
  Log log_;
  SettingsKeeper keeper_;
};

/// Returns a chip with the given times whose sectors are all erased and marked.
inline FlashChip settled(const FlashChip::Times& times = {}) {
  FlashChip chip;
  chip.times = times;
  OnFlash(chip).settle();
  return chip;
}

}  // namespace ex9000::hal::flash
