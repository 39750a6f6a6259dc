#include "firmware/settings/store.hpp"

#include <limits>

namespace ex9000 {

namespace {

/// Zeros in the first bytes of a copy, which include its layout, invalidate it.
constexpr std::size_t kInvalidatedSize = 8;

}  // namespace

// --- jobs ---

/// Returns the size in bytes of the read or write that begins at `done_`: up to the end of the page or of the
/// copy. A job that invalidates a copy has another size.
std::size_t SettingsStore::page_size() const {
  const std::size_t left = copy_size_ - done_;
  return left < kMemoryPage ? left : kMemoryPage;
}

MemoryJob SettingsStore::job() {
  using Kind = MemoryJob::Kind;
  if (step_ == Step::Invalidate) {
    return {Kind::Write, kPlaces[place_], {read_back_.data(), kInvalidatedSize}};
  }
  const bool writing = step_ == Step::Write;
  RecordBytes& bytes = writing ? record_ : read_back_;
  const auto address = static_cast<std::uint16_t>(kPlaces[place_] + done_);
  return {writing ? Kind::Write : Kind::Read, address, {bytes.data() + done_, page_size()}};
}

void SettingsStore::done(bool ok) {
  switch (step_) {  // not covered: the enumeration has no other value
    case Step::Load:
    case Step::LookAgain:
      read_page(ok);
      break;
    case Step::Write:
      if (ok) {
        step_ = Step::Verify;
      } else {
        retry_or_give_up();
      }
      break;
    case Step::Verify:
      verify_page(ok);
      break;
    case Step::Invalidate:
      if (ok) {
        step_ = Step::CheckInvalid;
      } else {
        invalidate_from(place_ + 1);
      }
      break;
    case Step::CheckInvalid:
      check_invalid(ok);
      break;
    case Step::Idle:  // not covered: no job is running while idle
      break;
  }
}

void SettingsStore::begin_copy(std::size_t place) {
  place_ = place;
  done_ = 0;
  copy_size_ = kMemoryPage;  // for reading: `read_page` sets the real size after the first page
  attempt_ = 0;
}

// --- reading ---

void SettingsStore::begin_reading(Step step) {
  step_ = step;
  blank_places_ = 0;
  bad_copy_ = false;
  current_place_ = kNoPlace;
  silent_ = false;
  begin_copy(0);
}

/// Counts the page that was read. Returns whether the copy has more pages.
bool SettingsStore::copy_goes_on() {
  done_ += page_size();
  copy_size_ = record_size({read_back_.data(), kMemoryPage});
  return done_ < copy_size_;
}

void SettingsStore::read_page(bool ok) {
  if (ok && copy_goes_on()) {
    return;
  }
  const bool blank = ok && is_blank({read_back_.data(), kMemoryPage});
  const auto stored = ok ? read_record(model_.get(), {read_back_.data(), done_}) : std::nullopt;
  const std::uint8_t attempts = !ok && silent_ ? 1 : kAttempts;
  if (!stored && !blank && ++attempt_ < attempts) {
    done_ = 0;
    copy_size_ = kMemoryPage;
    return;
  }
  silent_ = !ok;
  if (!ok && step_ == Step::LookAgain) {
    saved_ = false;  // the memory does not answer, so a write would fail too
    step_ = Step::Idle;
    return;
  }
  if (blank) {
    ++blank_places_;
  }
  if (!blank && !stored) {
    bad_copy_ = true;
  }
  unread_places_ = ok ? unread_places_ & ~bit(place_) : unread_places_ | bit(place_);
  if (stored) {
    take_copy(*stored);
  }
  next_place();
}

/// Processes a good copy at the place that was read.
void SettingsStore::take_copy(const StoredSettings& stored) {
  const bool refused = (copies_to_invalidate_ & bit(place_)) != 0;
  if (refused || (current_place_ != kNoPlace && !is_later(stored.sequence, sequence_))) {
    return;
  }
  current_place_ = place_;
  sequence_ = stored.sequence;
  record_ = read_back_;
  if (step_ == Step::Load) {
    stored_ = stored.settings;
  }
}

void SettingsStore::next_place() {
  if (place_ + 1 < kPlaces.size()) {
    begin_copy(place_ + 1);
  } else {
    finish_reading();
  }
}

void SettingsStore::finish_reading() {
  if (step_ == Step::LookAgain) {
    begin_writing();
    return;
  }
  step_ = Step::Idle;
  if (current_place_ == kNoPlace) {
    found_ = blank_places_ == kPlaces.size() ? Found::Blank : Found::Unreadable;
    stored_ = Settings::factory(model_.get());
  } else {
    found_ = Found::Settings;
  }
  source_ = source_of_settings();
}

SettingsStore::Source SettingsStore::source_of_settings() const {
  if (found_ != Found::Settings) {
    return found_ == Found::Blank ? Source::Blank : Source::NoneGood;
  }
  return bad_copy_ ? Source::OneCopyBad : Source::Good;
}

// --- writing ---

void SettingsStore::begin_saving(const Settings& settings) {
  saving_ = settings;
  if (found_ == Found::Unreadable) {
    begin_reading(Step::LookAgain);
  } else {
    begin_writing();
  }
}

void SettingsStore::begin_writing() {
  write_record(model_.get(), saving_, static_cast<std::uint16_t>(sequence_ + 1U), record_);
  begin_copy(current_place_ == 0 ? 1 : 0);
  copy_size_ = record_size({record_.data(), record_.size()});
  step_ = Step::Write;
}

void SettingsStore::verify_page(bool ok) {
  bool same = ok;
  for (std::size_t i = done_; i < done_ + page_size(); ++i) {
    same = same && read_back_[i] == record_[i];
  }
  if (!same) {
    retry_or_give_up();
    return;
  }
  done_ += page_size();
  if (done_ < copy_size_) {
    step_ = Step::Write;
  } else {
    finish_writing();
  }
}

void SettingsStore::retry_or_give_up() {
  if (++attempt_ < kAttempts) {
    step_ = Step::Write;
    return;
  }
  // The copy may be complete although the memory reported an error.
  copies_to_invalidate_ |= bit(place_);
  saved_ = false;
  invalidate_from(0);
}

void SettingsStore::finish_writing() {
  found_ = Found::Settings;
  unread_places_ &= ~bit(place_);
  current_place_ = place_;
  ++sequence_;
  stored_ = saving_;
  copies_to_invalidate_ &= ~bit(place_);
  saved_ = true;
  if (saves_ != std::numeric_limits<std::uint16_t>::max()) {
    ++saves_;
  }
  invalidate_from(0);
}

// --- invalidating ---

void SettingsStore::begin_invalidating() {
  saved_ = true;  // there is nothing to save, so no save can fail
  invalidate_from(0);
}

/// Begins to invalidate the first copy at `place` or later that must not be used. Becomes idle if there is
/// none.
void SettingsStore::invalidate_from(std::size_t place) {
  while (place < kPlaces.size() && (copies_to_invalidate_ & bit(place)) == 0) {
    ++place;
  }
  if (place == kPlaces.size()) {
    step_ = Step::Idle;
    return;
  }
  begin_copy(place);
  read_back_.fill(0);
  step_ = Step::Invalidate;
}

/// Reads the invalidated copy as a reset would, because the memory may acknowledge a write without effect. A
/// copy that is older than the current one may stay: it holds settings of an earlier save.
void SettingsStore::check_invalid(bool ok) {
  if (ok && copy_goes_on()) {
    return;
  }
  if (ok) {
    const auto stored = read_record(model_.get(), {read_back_.data(), done_});
    const bool counts = stored && (current_place_ == kNoPlace || is_later(stored->sequence, sequence_));
    if (!counts) {
      copies_to_invalidate_ &= ~bit(place_);
    }
  }
  invalidate_from(place_ + 1);
}

}  // namespace ex9000
