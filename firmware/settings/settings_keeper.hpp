// Loads and stores the settings of the module, and retries after a failed access to the memory.
#pragma once

#include <cstdint>

#include "firmware/model/built.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/memory_job.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Loads the settings at reset and stores the settings of a command. The settings in force are the current
/// settings of the module (State::settings). In addition, the keeper does the following without a command:
/// - It stores the settings in force after a timeout of the host watchdog has changed them.
/// - It withdraws the record of a failed save.
///
/// It retries both every second until they succeed or are no longer necessary (wire.md D15). For the main
/// loop only. None of the functions blocks. The keeper does not access the memory: the owner of the memory
/// carries out `job()` and then calls `done()`.
class SettingsKeeper {
 public:
  explicit constexpr SettingsKeeper(const Model& model) : model_(model) {}

  /// Returns whether the settings are still being loaded. When loading has ended, `stored()`,
  /// `unreadable()`, `source()` and `certain()` are valid.
  [[nodiscard]] bool loading() const { return step_ == Step::Load; }
  /// Returns the settings that a reset now would load, if `certain()`.
  [[nodiscard]] const Settings& stored() const { return stored_; }
  /// Returns whether the settings could not be read at reset, and no settings have been stored since.
  /// Settings cannot be read if the memory contains no good record for this model, and is not blank or does
  /// not answer.
  [[nodiscard]] bool unreadable() const { return unreadable_; }
  /// Returns what loading found. Does not change after that.
  [[nodiscard]] SettingsSource source() const { return source_; }
  /// Returns the number of saves that have succeeded since reset, at most 65535.
  [[nodiscard]] std::uint16_t saves() const { return saves_; }
  /// Returns whether a reset now would certainly load `stored()`.
  [[nodiscard]] bool certain() const { return !unreadable_ && memory_.certain; }

  /// Returns whether a job is waiting or running.
  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  /// Starts to store the settings of a command. Call this only while not `busy()`. `saved()` is valid as soon
  /// as `busy()` is false again.
  void save(const Settings& settings, Time now);
  [[nodiscard]] bool saved() const { return saved_; }

  /// Call this when the settings in force have changed without a command, so that `poll` compares them with
  /// the stored settings.
  void settings_changed() { may_differ_ = true; }
  /// Starts to store `in_force` or to withdraw a record, if necessary. Call this in every pass of the main
  /// loop when loading has ended.
  void poll(const Settings& in_force, Time now);
  /// The time of the next retry of a failed action; disarmed if no failed action waits.
  [[nodiscard]] Deadline retry() const { return busy() ? Deadline() : retry_; }

  /// Returns the job to carry out. Call this only while `busy()`. The result stays the same until `done`.
  [[nodiscard]] MemoryJob job();
  /// Call this when the job has ended.
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
  /// Of the next record, relative to `sequence_`: 1 or 2. It differs from that of a refused record, whose end
  /// may still be in the memory, so that no power failure can complete that record with the next one.
  std::uint8_t ahead_ = 1;
  RecordBytes record_{};  ///< that record, or the record of the last save; zeros if there is none
};

}  // namespace ex9000
