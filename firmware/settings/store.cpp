#include "firmware/settings/store.hpp"

namespace ex9000 {

namespace {

/// Apart by a page of the smallest pages that any supported EEPROM has, so that a torn page harms one copy
/// only.
constexpr std::uint16_t kCopyDistance = 32;
static_assert(kRecordSize <= kCopyDistance, "a copy must fit one page");

constexpr std::size_t kCheckBytes = kRecordSize - kRecordCheckAt;

constexpr std::uint16_t address_of(std::uint8_t copy) {
  return static_cast<std::uint16_t>(copy * kCopyDistance);
}

}  // namespace

void SettingsStore::begin_reading(Step step) {
  step_ = step;
  copy_ = 0;
  attempt_ = 0;
  blank_copies_ = 0;
  current_copy_ = kNoCopy;
}

void SettingsStore::begin_saving(const Settings& settings) {
  fill_record(settings, static_cast<std::uint16_t>(sequence_ + 1U), record_);
  if (found_ == Found::Unreadable) {
    begin_reading(Step::LookAgain);
  } else {
    begin_writing();
  }
}

void SettingsStore::begin_writing() {
  copy_ = current_copy_ == 0 ? 1 : 0;
  attempt_ = 0;
  step_ = Step::Write;
}

MemoryJob SettingsStore::job() {
  using Kind = MemoryJob::Kind;
  const std::uint16_t address = address_of(copy_);
  if (step_ == Step::Write) {
    return {Kind::Write, address, {record_.bytes.data(), kRecordSize}};
  }
  if (step_ == Step::Invalidate) {
    return {Kind::Write,
            static_cast<std::uint16_t>(address + kRecordCheckAt),
            {record_.bytes.data() + kRecordCheckAt, kCheckBytes}};
  }
  return {Kind::Read, address, {read_back_.bytes.data(), kRecordSize}};
}

/// The check takes its time; the bytes before it take longer on their way.
void SettingsStore::started() {
  if (step_ == Step::Write) {
    seal_record(model_.get(), record_);
  }
}

void SettingsStore::done(bool ok) {
  switch (step_) {  // not covered: every value has its case
    case Step::Load:
    case Step::LookAgain:
      read_copy(ok);
      break;
    case Step::Write:
      if (ok) {
        step_ = Step::Verify;
      } else {
        retry_or_give_up();
      }
      break;
    case Step::Verify:
      if (ok && read_back_ == record_) {
        finish_saving(true);
      } else {
        retry_or_give_up();
      }
      break;
    case Step::Invalidate:
      doubtful_copy_ = ok ? kNoCopy : copy_;
      finish_saving(false);
      break;
    case Step::Idle:  // not covered: nothing ends where nothing was begun
      break;
  }
}

void SettingsStore::read_copy(bool ok) {
  const bool good = ok && is_good(model_.get(), read_back_);
  const bool blank = ok && is_blank(read_back_);
  if (!good && !blank && ++attempt_ < kAttempts) {
    return;
  }
  if (!ok && step_ == Step::LookAgain) {
    finish_saving(false);  // what does not answer is not written to either
    return;
  }
  blank_copies_ = static_cast<std::uint8_t>(blank_copies_ + (blank ? 1U : 0U));
  if (good) {
    const std::uint16_t sequence = sequence_in(read_back_);
    if (current_copy_ == kNoCopy || is_later(sequence, sequence_)) {
      sequence_ = sequence;
      current_copy_ = copy_;
      if (step_ == Step::Load) {
        stored_ = settings_in(read_back_);
      }
    }
  }
  attempt_ = 0;
  if (++copy_ == kCopies) {
    finish_reading();
  }
}

void SettingsStore::finish_reading() {
  if (step_ == Step::LookAgain) {
    // What was found may be later than what was known.
    fill_record(settings_in(record_), static_cast<std::uint16_t>(sequence_ + 1U), record_);
    begin_writing();
    return;
  }
  step_ = Step::Idle;
  if (current_copy_ != kNoCopy) {
    found_ = Found::Settings;
    return;
  }
  found_ = blank_copies_ == kCopies ? Found::Blank : Found::Unreadable;
  stored_ = Settings::factory(model_.get());
}

void SettingsStore::retry_or_give_up() {
  if (++attempt_ < kAttempts) {
    step_ = Step::Write;
  } else {
    // The copy may hold the new settings all the same and only not have said so. It must not count after a
    // reset.
    begin_invalidating();
  }
}

void SettingsStore::begin_settling() {
  copy_ = doubtful_copy_;
  begin_invalidating();
}

/// A check of zeros: the odds of it being right are those of any other.
void SettingsStore::begin_invalidating() {
  for (std::size_t i = kRecordCheckAt; i < kRecordSize; ++i) {
    record_.bytes[i] = 0;
  }
  step_ = Step::Invalidate;
}

void SettingsStore::finish_saving(bool saved) {
  saved_ = saved;
  step_ = Step::Idle;
  if (saved) {
    stored_ = settings_in(record_);
    ++sequence_;
    doubtful_copy_ = kNoCopy;
    current_copy_ = copy_;
    found_ = Found::Settings;
  }
}

}  // namespace ex9000
