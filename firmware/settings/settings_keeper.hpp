// Stores the current settings of the module, and retries after a failed access to the memory.
#pragma once

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/settings/store.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Loads the settings at reset and stores the settings of a command. The settings in force are the current
/// settings of the module (State::settings). In addition, the keeper does the following without a command:
/// - It stores the settings in force after a timeout of the host watchdog has changed them.
/// - It invalidates the copies of failed saves.
///
/// It retries both every second until they succeed or are no longer necessary (wire.md D15). For the main
/// loop only. None of the functions blocks.
class SettingsKeeper {
 public:
  explicit constexpr SettingsKeeper(const Model& model) : store_(model) {}

  /// Returns whether the settings are still being loaded. When loading has ended, `stored()`,
  /// `unreadable()`, `source()` and `certain()` are valid.
  [[nodiscard]] bool loading() const { return store_.loading(); }
  /// Returns the settings that a reset now would load, if `certain()`.
  [[nodiscard]] const Settings& stored() const { return store_.stored(); }
  /// Returns whether the settings could not be read at reset, and no settings have been stored since.
  /// Settings cannot be read if the memory contains no good copy for this model, and at least one place is
  /// not blank or does not answer.
  [[nodiscard]] bool unreadable() const { return store_.found() == SettingsStore::Found::Unreadable; }

  /// See SettingsStore::source and SettingsStore::saves.
  [[nodiscard]] SettingsStore::Source source() const { return store_.source(); }
  [[nodiscard]] std::uint16_t saves() const { return store_.saves(); }

  /// Returns whether a reset now would certainly load `stored()`. This is not certain while `unreadable()`,
  /// SettingsStore::place_unread or SettingsStore::needs_invalidation returns true.
  [[nodiscard]] bool certain() const {
    return !unreadable() && !store_.place_unread() && !store_.needs_invalidation();
  }

  /// Returns whether a memory access, `job()`, is waiting or running.
  [[nodiscard]] bool busy() const { return store_.busy(); }
  /// Starts to store the settings of a command. Call this only while not `busy()`. `saved()` is valid as soon
  /// as `busy()` is false again.
  void save(const Settings& settings, Time now);
  /// Shortens a save that does not belong to a command: the next failed attempt ends the save, and the keeper
  /// retries it later if it is still necessary. Call this while a command waits for this save, so that the
  /// reply to the command is not late if the memory fails.
  void let_command_through() {
    if (own_save_) {
      store_.give_up_at_next_failure();
    }
  }
  [[nodiscard]] bool saved() const { return store_.saved(); }

  /// Call this when the settings in force have changed without a command, so that `poll` compares them with
  /// the stored settings.
  void settings_changed() { may_differ_ = true; }
  /// Starts to store `in_force` or to invalidate a copy, if necessary. Call this in every pass of the main
  /// loop when loading has ended.
  void poll(const Settings& in_force, Time now);
  /// The time of the next retry of a failed action; disarmed if no failed action waits.
  [[nodiscard]] Deadline retry() const { return busy() ? Deadline() : retry_; }

  // --- memory access; see SettingsStore ---

  [[nodiscard]] MemoryJob job() { return store_.job(); }
  void done(bool ok) { store_.done(ok); }

 private:
  void end_own_save(Time now);

  SettingsStore store_;
  bool may_differ_ = false;  ///< the settings in force may differ from the stored settings
  bool own_save_ = false;    ///< the action that runs or has just ended belongs to no command
  Deadline retry_;
};

}  // namespace ex9000
