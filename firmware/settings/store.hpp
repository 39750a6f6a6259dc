// Keeps the settings in a memory that takes time to write and may lose power at any instant.
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

/// What the store needs done with the memory. The buffers live until `SettingsStore::done`.
struct MemoryJob {
  enum class Kind : std::uint8_t { Read, Write };

  Kind kind = Kind::Read;
  std::uint16_t address = 0;  ///< of the first byte; a job never crosses the end of a page (kMemoryPage)
  MutableBytes bytes;         ///< to be filled, or to be written
};

/// Two copies of the settings, each in a place of its own (places.hpp). A save overwrites the older or broken
/// one, page by page, and reads back each page. Only the check at the end of the whole copy makes it count,
/// and the other copy stays as it is. So a power cut leaves either the old settings or the new ones.
///
/// The first save after an update leaves the copies of older layouts in the same way. When it is verified, it
/// invalidates them: they must not count again, even if both newer copies fail later.
///
/// The store does nothing by itself: whoever owns the memory starts `job()` and reports `done()` when it has
/// ended.
class SettingsStore {
 public:
  enum class Found : std::uint8_t {
    Settings,    ///< a good copy
    Blank,       ///< never written: factory settings
    Unreadable,  ///< something else; factory settings are used, and not written
  };

  /// Begins to load: reads all places, each up to three times. A memory that did not answer at one place is
  /// asked once at the next. Afterwards `found()` and `stored()` hold.
  explicit constexpr SettingsStore(const Model& model) : model_(model) {}
  [[nodiscard]] bool loading() const { return step_ == Step::Load; }
  [[nodiscard]] Found found() const { return found_; }

  /// Writes and verifies; the third failure of any page ends it. Only while not `busy()`. Afterwards
  /// `saved()` and `stored()` hold.
  ///
  /// If no copy could be read at reset, all are read once more first: one that answers now must not count as
  /// the later one after the next reset.
  void begin_saving(const Settings& settings);
  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  /// Whether the last save succeeded.
  [[nodiscard]] bool saved() const { return saved_; }

  /// The power failed in the first save after an update: the new copy counts, and so may those of an older
  /// layout. One good reading does not prove that the new one is well written, so they stay until a save has
  /// been verified.
  [[nodiscard]] bool update_unfinished() const {
    return current_place_ != kNoPlace && !kPlaces[current_place_].old && old_copies_ != 0;
  }

  /// A copy may count after a reset that must not: one of refused settings, or one of an older layout.
  [[nodiscard]] bool doubtful() const { return must_not_count_ != 0; }
  /// Invalidates it. Only while not `busy()`; `doubtful()` stays true if the memory does not take this
  /// either.
  void begin_settling();

  /// The settings that a reset now would find.
  [[nodiscard]] const Settings& stored() const { return stored_; }

  /// What has to be done, while `busy()`; the same until `done`.
  [[nodiscard]] MemoryJob job();
  /// The job has ended: `ok` unless the memory did not answer.
  void done(bool ok);

 private:
  enum class Step : std::uint8_t { Idle, Load, LookAgain, Write, Verify, Invalidate };

  void begin_reading(Step step);
  void read_page(bool ok);
  void take_copy(const StoredSettings& stored);
  void next_place();
  void finish_reading();
  void begin_writing();
  void verify_page(bool ok);
  void retry_or_give_up();
  void begin_copy(std::size_t place);
  [[nodiscard]] std::size_t page_size() const;
  void finish_writing();
  void invalidate_from(std::size_t place);

  static constexpr std::size_t kNoPlace = kPlaces.size();
  static constexpr std::uint8_t kAttempts = 3;
  static constexpr unsigned bit(std::size_t place) { return 1U << place; }

  ChosenModel model_;
  Step step_ = Step::Load;
  Found found_ = Found::Unreadable;
  bool saved_ = false;

  std::size_t place_ = 0;                ///< of the copy that is read or written
  std::size_t done_ = 0;                 ///< so many of its bytes are
  std::size_t copy_size_ = kMemoryPage;  ///< and so many it takes
  std::uint8_t attempt_ = 0;             ///< failures so far
  bool silent_ = false;                  ///< the memory did not answer at the last place
  std::uint8_t blank_places_ = 0;
  std::size_t current_place_ = kNoPlace;  ///< of the copy that counts
  unsigned old_copies_ = 0;               ///< bit n: place n holds a good copy of an older layout
  unsigned must_not_count_ = 0;           ///< bit n: the copy at place n has to be invalidated

  Edition edition_;          ///< of the copy that counts
  Settings stored_;          ///< what it holds
  Settings saving_;          ///< what is being saved
  RecordBytes record_{};     ///< the record that counts, then the one that is written; zeros if there is none
  RecordBytes read_back_{};  ///< what is read
};

}  // namespace ex9000
