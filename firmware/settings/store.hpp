// Keeps the settings in a memory that takes time to write and may lose power at any instant.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/model/built.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// What the store needs done with the memory. The buffers live until `SettingsStore::done`.
struct MemoryJob {
  enum class Kind : std::uint8_t { Read, Write };

  Kind kind = Kind::Read;
  std::uint16_t address = 0;  ///< of the first byte; a job never crosses a page
  MutableBytes bytes;         ///< to be filled, or to be written
};

/// Two copies, each in a page of its own. A save overwrites the older or broken one, reads it back, and only
/// then does it count; the other copy stays as it is, so a power cut leaves either the old settings or the
/// new ones.
///
/// The store does nothing by itself: whoever owns the memory starts `job()`, reports that it has `started()`,
/// and reports `done()` when it has ended.
class SettingsStore {
 public:
  enum class Found : std::uint8_t {
    Settings,    ///< a good copy
    Blank,       ///< never written: factory settings
    Unreadable,  ///< something else; factory settings are used, and not written
  };

  /// Begins to load: reads both copies, each up to three times. Afterwards `found()` and `stored()` hold.
  explicit constexpr SettingsStore(const Model& model) : model_(model) {}
  [[nodiscard]] bool loading() const { return step_ == Step::Load; }
  [[nodiscard]] Found found() const { return found_; }

  /// Writes and verifies, up to three times. Only while not `busy()`. Afterwards `saved()` and `stored()`
  /// hold.
  ///
  /// Where no copy could be read at reset, both are read once more first: one that answers now must not count
  /// as the later one after the next reset.
  void begin_saving(const Settings& settings);
  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  /// Whether the last save succeeded.
  [[nodiscard]] bool saved() const { return saved_; }

  /// A save has failed, and its copy may hold the refused settings all the same.
  [[nodiscard]] bool doubtful() const { return doubtful_copy_ != kNoCopy; }
  /// Makes sure that it does not count. Only while not `busy()`; `doubtful()` stays where this fails too.
  void begin_settling();

  /// What a reset now would find.
  [[nodiscard]] const Settings& stored() const { return stored_; }

  /// What is to be done, while `busy()`; the same until `done`.
  [[nodiscard]] MemoryJob job();
  /// The memory was given the job. Of what is to be written the last bytes are there only from here on.
  void started();
  /// The job has ended: `ok` unless the memory did not answer.
  void done(bool ok);

 private:
  enum class Step : std::uint8_t { Idle, Load, LookAgain, Write, Verify, Invalidate };

  void begin_reading(Step step);
  void read_copy(bool ok);
  void finish_reading();
  void begin_writing();
  void begin_invalidating();
  void retry_or_give_up();
  void finish_saving(bool saved);

  static constexpr std::uint8_t kCopies = 2;
  static constexpr std::uint8_t kNoCopy = 0xFF;
  static constexpr std::uint8_t kAttempts = 3;

  ChosenModel model_;
  Step step_ = Step::Load;
  Found found_ = Found::Unreadable;
  bool saved_ = false;
  std::uint8_t copy_ = 0;
  std::uint8_t attempt_ = 0;
  std::uint8_t blank_copies_ = 0;
  std::uint8_t current_copy_ = kNoCopy;   ///< the one that counts
  std::uint8_t doubtful_copy_ = kNoCopy;  ///< the one that must not
  std::uint16_t sequence_ = 0;            ///< its
  Settings stored_;                       ///< what it holds
  Record record_;                         ///< what is written
  Record read_back_;                      ///< what is read
};

}  // namespace ex9000
