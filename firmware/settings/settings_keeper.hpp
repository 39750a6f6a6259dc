// Loads and stores the settings, and retries after a failed access to the memory.
#pragma once

#include <cstdint>

#include "firmware/model/built.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/memory_job.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Loads at reset and stores for a command. Without a command, it stores the settings in force
/// (State::settings) after a timeout of the host watchdog has changed them, and withdraws the record of a
/// failed save. It retries both every second until they succeed or are no longer necessary (wire.md D15).
///
/// For the main loop; nothing blocks. The owner of the memory carries out `job()`, then calls `done()`.
class SettingsKeeper {
 public:
  explicit constexpr SettingsKeeper(const Model& model) : model_(model) {}

  /// Only after loading are `stored()`, `unreadable()`, `source()` and `certain()` valid.
  [[nodiscard]] bool loading() const { return step_ == Step::Load; }
  /// What a reset now would load, if `certain()`.
  [[nodiscard]] const Settings& stored() const { return stored_; }
  /// No good record at reset, in a memory that is not blank or does not answer; no save since.
  [[nodiscard]] bool unreadable() const { return unreadable_; }
  /// What loading found. Does not change after that.
  [[nodiscard]] SettingsSource source() const { return source_; }
  /// Saves that have succeeded since reset, at most 65535.
  [[nodiscard]] std::uint16_t saves() const { return saves_; }
  [[nodiscard]] bool certain() const { return !unreadable_ && memory_.certain; }

  /// A job is waiting or running.
  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  /// Stores the settings of a command. Only while not `busy()`; `saved()` is valid when `busy()` ends.
  void save(const Settings& settings, Time now);
  [[nodiscard]] bool saved() const { return saved_; }

  /// When the settings in force changed without a command: `poll` compares them with the stored ones.
  void settings_changed() { may_differ_ = true; }
  /// Begins a save of `in_force` or a withdrawal if necessary. In every pass, when loading has ended.
  void poll(const Settings& in_force, Time now);
  /// When a failed action is tried again; disarmed if none waits.
  [[nodiscard]] Deadline retry() const { return busy() ? Deadline() : retry_; }

  /// Only while `busy()`. Stays the same until `done`.
  [[nodiscard]] MemoryJob job();
  void done(const MemoryResult& result);

 private:
  enum class Step : std::uint8_t { Idle, Load, LoadAgain, Save, Withdraw };

  void begin_saving(const Settings& settings, std::uint8_t attempts);
  void begin_writing();
  void use_record();
  void end_own_action(Time now);

  ChosenModel model_;
  Step step_ = Step::Load;
  MemoryResult memory_;
  SettingsSource source_ = SettingsSource::NoneGood;
  bool unreadable_ = true;
  bool saved_ = false;
  std::uint16_t saves_ = 0;
  bool may_differ_ = false;  ///< the settings in force may differ from the stored settings
  bool own_action_ = false;  ///< the action that runs or has just ended belongs to no command
  Deadline retry_;

  Settings stored_;
  Settings saving_;             ///< settings that are being saved
  std::uint8_t attempts_ = 0;   ///< of that save
  std::uint16_t sequence_ = 0;  ///< sequence number of the newest good record
  /// Of the next record, relative to `sequence_`: 1 or 2. Never that of a refused record, whose end may still
  /// be in the memory: a power failure must not complete that one with parts of the next.
  std::uint8_t ahead_ = 1;
  RecordBytes record_{};  ///< that record, or the record of the last save; zeros if there is none
};

}  // namespace ex9000
