// Keeps the stored settings equal to those in force, through failures of the memory.
#pragma once

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/settings/store.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Loads the settings at reset, and stores those of a command when it is asked to. What nobody asked for it
/// does by itself: it stores a watchdog timeout, which changes settings at once, repeats the first save
/// after an update if the power failed in it, and invalidates a copy that must not count. That is retried
/// every second until it succeeds (wire.md D15). Main loop only; nothing blocks.
class SettingsKeeper {
 public:
  explicit constexpr SettingsKeeper(const Model& model) : store_(model) {}

  /// Until the memory has been read. Afterwards `stored()` and `unreadable()` hold.
  [[nodiscard]] bool loading() const { return store_.loading(); }
  /// What a reset now would find, if `certain()`.
  [[nodiscard]] const Settings& stored() const { return store_.stored(); }
  /// The memory held something at reset that is not this model's settings, and none have been stored since.
  [[nodiscard]] bool unreadable() const { return store_.found() == SettingsStore::Found::Unreadable; }

  /// A reset now would find `stored()` for certain, or a blank memory: not settings that could not be read
  /// before, and no copy that must not count.
  [[nodiscard]] bool certain() const {
    return !unreadable() && !store_.doubtful() && !store_.update_unfinished();
  }

  /// The memory is at work.
  [[nodiscard]] bool busy() const { return store_.busy(); }
  /// Stores settings for a command; only while not `busy()`. When it is not busy any more, `saved()` holds.
  void save(const Settings& settings, Time now);
  [[nodiscard]] bool saved() const { return store_.saved(); }

  /// The settings in force have changed and may not be what is stored.
  void settings_changed() { may_differ_ = true; }
  /// Every turn: stores `in_force` if that is necessary.
  void poll(const Settings& in_force, Time now);
  /// `poll` has something to do.
  [[nodiscard]] bool has_work() const { return own_save_ && !busy(); }
  /// When it tries again; disarmed if nothing failed.
  [[nodiscard]] Deadline retry() const { return retry_; }

  // --- the memory's side; see SettingsStore ---

  [[nodiscard]] MemoryJob job() { return store_.job(); }
  void done(bool ok) { store_.done(ok); }

 private:
  void end_own_save(Time now);

  SettingsStore store_;
  bool may_differ_ = false;  ///< the settings in force may not be stored
  bool own_save_ = false;    ///< the store that is under way was not asked for by a command
  Deadline retry_;
};

}  // namespace ex9000
