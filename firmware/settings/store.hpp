// Stores the settings in a memory whose writes take time. The power may fail at any time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/model/built.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/places.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// A memory access that the store requests. The buffer is valid until `SettingsStore::done`.
struct MemoryJob {
  enum class Kind : std::uint8_t { Read, Write };

  Kind kind = Kind::Read;
  std::uint16_t address = 0;  ///< address of the first byte; a job stays within a page (kMemoryPage)
  MutableBytes bytes;         ///< buffer for the bytes to read or write
};

/// Keeps up to two copies of the settings, each in its own place (places.hpp). A save does not change the
/// current copy: it writes a new copy to the other place, page by page, and reads back each page. The new
/// copy becomes valid only when the check at its end is written. After a power failure, the store therefore
/// loads either the old or the new settings.
///
/// The store does not access the memory. The owner of the memory carries out `job()` and then calls `done()`.
class SettingsStore {
 public:
  /// The result of loading. A successful save changes it to Settings. A place is blank if its first
  /// kMemoryPage bytes are FF.
  enum class Found : std::uint8_t {
    Settings,    ///< the memory contains a good copy
    Blank,       ///< all places are blank; factory settings are used
    Unreadable,  ///< no good copy, and a place is not blank or does not answer; factory settings are used
  };

  /// The origin of the settings that were loaded at reset: register 0x0306 (firmware/extensions.md).
  enum class Source : std::uint8_t {
    Good = 0,        ///< a good copy; the other place has a good copy or is blank
    OneCopyBad = 1,  ///< a good copy; the other place has no good copy and is not blank
    NoneGood = 2,    ///< no good copy, and not all places are blank: factory settings
    Blank = 4,       ///< all places are blank: factory settings; 3 is for a copy of an older layout
  };

  /// Begins to load: reads all places, each up to three times. If the last read at a place gets no answer,
  /// and a read at the next place gets no answer either, the store does not repeat the read at the next
  /// place. `found()` and `stored()` are valid when loading has ended.
  explicit constexpr SettingsStore(const Model& model) : model_(model) {}
  [[nodiscard]] bool loading() const { return step_ == Step::Load; }
  [[nodiscard]] Found found() const { return found_; }
  /// Valid when loading has ended; does not change after that.
  [[nodiscard]] Source source() const { return source_; }
  /// Returns the number of saves that have succeeded since reset, at most 65535.
  [[nodiscard]] std::uint16_t saves() const { return saves_; }

  /// Begins to write and verify `settings`. The save fails when writing or verifying has failed three times.
  /// Call this only while not `busy()`. `saved()` and `stored()` are valid when the save has ended.
  ///
  /// If `found()` is Unreadable, the store first reads all places again. If the memory does not answer, the
  /// save fails. If a copy is readable now, the new copy gets a later sequence number, so that the next reset
  /// loads the new copy.
  void begin_saving(const Settings& settings);
  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  /// Makes the running save fail at its next failed attempt to write or verify. Has no effect unless the
  /// store is writing or verifying.
  void give_up_at_next_failure() {
    if (step_ == Step::Write || step_ == Step::Verify) {
      attempt_ = kAttempts - 1;
    }
  }
  /// Returns whether the last save succeeded. After `begin_invalidating`, which saves nothing, returns true.
  [[nodiscard]] bool saved() const { return saved_; }

  /// Returns whether the memory did not answer at a place while the settings were loaded, and a later reset
  /// may find a copy there that is newer than the current copy. If a successful save overwrites such a place,
  /// this place no longer counts.
  [[nodiscard]] bool place_unread() const { return unread_places_ != 0; }

  /// Returns whether a reset now could load the copy of a failed save.
  [[nodiscard]] bool needs_invalidation() const { return copies_to_invalidate_ != 0; }
  /// Begins to invalidate the copies of failed saves. Call this only while not `busy()`. If a copy cannot be
  /// invalidated, `needs_invalidation()` stays true.
  void begin_invalidating();

  /// Returns the settings that a reset now would load; for the exceptions, see SettingsKeeper::certain.
  [[nodiscard]] const Settings& stored() const { return stored_; }

  /// Returns the memory access to carry out. Call this only while `busy()`. The result stays the same until
  /// `done`.
  [[nodiscard]] MemoryJob job();
  /// Call this when the job has ended. `ok`: the job succeeded. If a job fails for any reason, the store
  /// treats it like a job that the memory did not answer.
  void done(bool ok);

 private:
  enum class Step : std::uint8_t { Idle, Load, LookAgain, Write, Verify, Invalidate, CheckInvalid };

  void begin_reading(Step step);
  [[nodiscard]] bool copy_goes_on();
  void read_page(bool ok);
  void take_copy(const StoredSettings& stored);
  void next_place();
  void finish_reading();
  [[nodiscard]] Source source_of_settings() const;
  void begin_writing();
  void verify_page(bool ok);
  void retry_or_give_up();
  void begin_copy(std::size_t place);
  [[nodiscard]] std::size_t page_size() const;
  void finish_writing();
  void invalidate_from(std::size_t place);
  void check_invalid(bool ok);

  static constexpr std::size_t kNoPlace = kPlaces.size();
  static constexpr std::uint8_t kAttempts = 3;
  static constexpr unsigned bit(std::size_t place) { return 1U << place; }

  ChosenModel model_;
  Step step_ = Step::Load;
  Found found_ = Found::Unreadable;
  Source source_ = Source::NoneGood;
  bool saved_ = false;
  std::uint16_t saves_ = 0;

  std::size_t place_ = 0;                ///< place of the copy that is being read, written or invalidated
  std::size_t done_ = 0;                 ///< bytes of that copy that have been processed
  std::size_t copy_size_ = kMemoryPage;  ///< size of that copy in bytes
  std::uint8_t attempt_ = 0;             ///< failed attempts at that copy
  bool silent_ = false;                  ///< the memory did not answer the last read at the previous place
  std::uint8_t blank_places_ = 0;
  bool bad_copy_ = false;                 ///< a place is not blank and has no good copy
  unsigned unread_places_ = 0;            ///< places whose last read got no answer; bit n is place n
  std::size_t current_place_ = kNoPlace;  ///< place of the current copy, the newest good one; or kNoPlace
  unsigned copies_to_invalidate_ = 0;     ///< bit n: the copy at place n must be invalidated

  std::uint16_t sequence_ = 0;  ///< sequence number of the current copy
  Settings stored_;             ///< result of `stored()`
  Settings saving_;             ///< settings that are being saved
  RecordBytes record_{};        ///< the current record, or that of the last save; zeros if there is none
  RecordBytes read_back_{};     ///< bytes read from the memory, or zeros to write
};

}  // namespace ex9000
