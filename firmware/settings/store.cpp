#include "firmware/settings/store.hpp"

namespace ex9000 {

namespace {

/// Apart by a page of the smallest pages that any supported EEPROM has, so that a torn page harms one copy
/// only.
constexpr std::uint16_t kCopyDistance = 32;
static_assert(kRecordSize <= kCopyDistance, "a copy must fit one page");

constexpr std::size_t kCheckBytes = 4;
constexpr std::array<std::uint8_t, kCheckBytes> kNoCheck{};

constexpr std::uint16_t address_of(std::uint8_t copy) {
  return static_cast<std::uint16_t>(copy * kCopyDistance);
}

/// Sequence numbers wrap; the later one is less than half the range ahead.
constexpr bool is_later(std::uint16_t a, std::uint16_t b) {
  return static_cast<std::uint16_t>(a - b) - 1U < 0x7FFFU;
}

}  // namespace

void SettingsStore::begin_loading() { begin_reading(Step::Load); }

void SettingsStore::begin_reading(Step step) {
  step_ = step;
  copy_ = 0;
  attempt_ = 0;
  blank_copies_ = 0;
  current_copy_ = kNoCopy;
}

void SettingsStore::begin_saving(const Settings& settings) {
  pending_ = settings;
  if (found_ == Found::Unreadable) {
    begin_reading(Step::LookAgain);
  } else {
    begin_writing();
  }
}

void SettingsStore::begin_writing() {
  record_ = encode_record(model_.get(), {pending_, static_cast<std::uint16_t>(stored_.sequence + 1U)});
  copy_ = current_copy_ == 0 ? 1 : 0;
  attempt_ = 0;
  step_ = Step::Write;
}

void SettingsStore::begin_settling() {
  copy_ = doubtful_copy_;
  step_ = Step::Invalidate;
}

MemoryJob SettingsStore::job() {
  MemoryJob job;
  job.address = address_of(copy_);
  switch (step_) {
    case Step::Load:
    case Step::LookAgain:
    case Step::Verify:
      job.kind = MemoryJob::Kind::Read;
      job.destination = {read_back_.data(), read_back_.size()};
      break;
    case Step::Write:
      job.kind = MemoryJob::Kind::Write;
      job.source = {record_.data(), record_.size()};
      break;
    case Step::Invalidate:
      job.kind = MemoryJob::Kind::Write;
      job.address = static_cast<std::uint16_t>(job.address + kRecordSize - kCheckBytes);
      job.source = {kNoCheck.data(), kNoCheck.size()};
      break;
    case Step::Idle:
      break;
  }
  return job;
}

void SettingsStore::done(bool ok) {
  switch (step_) {
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
    case Step::Idle:
      break;
  }
}

void SettingsStore::read_copy(bool ok) {
  const auto copy = ok ? decode_record(model_.get(), read_back_) : std::nullopt;
  const bool blank = ok && is_blank(read_back_);
  if (!copy && !blank && ++attempt_ < kAttempts) {
    return;
  }
  if (!ok && step_ == Step::LookAgain) {
    finish_saving(false);  // what does not answer is not written to either
    return;
  }
  blank_copies_ = static_cast<std::uint8_t>(blank_copies_ + (blank ? 1U : 0U));
  if (copy && (current_copy_ == kNoCopy || is_later(copy->sequence, stored_.sequence))) {
    stored_.sequence = copy->sequence;
    current_copy_ = copy_;
    if (step_ == Step::Load) {
      stored_.settings = copy->settings;
    }
  }
  attempt_ = 0;
  if (++copy_ == kCopies) {
    finish_reading();
  }
}

void SettingsStore::finish_reading() {
  if (step_ == Step::LookAgain) {
    begin_writing();
    return;
  }
  step_ = Step::Idle;
  if (current_copy_ != kNoCopy) {
    found_ = Found::Settings;
    return;
  }
  found_ = blank_copies_ == kCopies ? Found::Blank : Found::Unreadable;
  stored_ = {Settings::factory(model_.get()), 0};
}

void SettingsStore::retry_or_give_up() {
  // The copy may hold the new settings all the same and only not have said so. It must not count after a
  // reset.
  step_ = ++attempt_ < kAttempts ? Step::Write : Step::Invalidate;
}

void SettingsStore::finish_saving(bool saved) {
  saved_ = saved;
  step_ = Step::Idle;
  if (saved) {
    stored_ = {pending_, static_cast<std::uint16_t>(stored_.sequence + 1U)};
    doubtful_copy_ = kNoCopy;
    current_copy_ = copy_;
    found_ = Found::Settings;
  }
}

}  // namespace ex9000
