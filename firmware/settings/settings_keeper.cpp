#include "firmware/settings/settings_keeper.hpp"

#include "firmware/expect.hpp"
#include "firmware/request/statistics.hpp"

namespace ex9000 {

namespace {

// wire.md D15
constexpr Duration kRetry = milliseconds(1000);
constexpr std::uint8_t kAttemptsOfACommand = 3;
/// A save without a command tries only once, because a command may wait for its end.
constexpr std::uint8_t kOwnAttempts = 1;

Bytes bytes_of(const RecordBytes& record) { return {record.data(), record.size()}; }

}  // namespace

MemoryJob SettingsKeeper::job() {
  EX9000_EXPECT(busy());
  using Kind = MemoryJob::Kind;
  const Kind kind =
      step_ == Step::Save ? Kind::Save : (step_ == Step::Withdraw ? Kind::Withdraw : Kind::Load);
  const std::size_t size = kind == Kind::Save ? record_size(bytes_of(record_)) : record_.size();
  return {kind, &model_.get(), {record_.data(), size}, attempts_};
}

void SettingsKeeper::done(const MemoryResult& result) {
  EX9000_EXPECT(busy());
  const Step step = step_;
  step_ = Step::Idle;
  memory_ = result;
  saved_ = result.succeeded || step == Step::Withdraw;  // a withdrawal saves nothing, so no save has failed
  switch (step) {                                       // not covered: the enumeration has no other value
    case Step::Load:
      source_ = result.source;
      unreadable_ = source_ == SettingsSource::NoneGood;
      use_record();
      break;
    case Step::LoadAgain:
      if (result.succeeded) {
        sequence_ = result.source == SettingsSource::NoneGood ? sequence_ : sequence_of(bytes_of(record_));
        begin_writing();
      }
      break;
    case Step::Save:
      if (result.succeeded) {
        sequence_ = sequence_of(bytes_of(record_));
        ahead_ = 1;
        stored_ = saving_;
        unreadable_ = false;
        count_saturating(saves_);
      } else {
        ahead_ = ahead_ == 1 ? 2 : 1;
      }
      break;
    case Step::Withdraw:
    case Step::Idle:  // not covered: no job is running while idle
      break;
  }
}

void SettingsKeeper::use_record() {
  const auto stored = read_record(model_.get(), bytes_of(record_));
  stored_ = stored ? stored->settings : Settings::factory(model_.get());
  sequence_ = stored ? stored->sequence : 0;
}

// --- saving ---

void SettingsKeeper::save(const Settings& settings, Time now) {
  EX9000_EXPECT(!busy());
  end_own_action(now);
  begin_saving(settings, kAttemptsOfACommand);
  may_differ_ = true;  // even if the save succeeds, because the host watchdog may expire during it
}

/// If the last load has found something bad, loads again first, because the newest record may be readable now
/// and must not be overwritten. The save fails if the memory does not answer.
void SettingsKeeper::begin_saving(const Settings& settings, std::uint8_t attempts) {
  saving_ = settings;
  attempts_ = attempts;
  if (memory_.source == SettingsSource::Good || memory_.source == SettingsSource::Blank) {
    begin_writing();
  } else {
    step_ = Step::LoadAgain;
  }
}

void SettingsKeeper::begin_writing() {
  EX9000_EXPECT(saving_.possible_for(model_.get()));
  write_record(model_.get(), saving_, static_cast<std::uint16_t>(sequence_ + ahead_), record_);
  step_ = Step::Save;
}

// --- without a command ---

void SettingsKeeper::poll(const Settings& in_force, Time now) {
  if (busy()) {
    return;
  }
  end_own_action(now);
  const bool unsaved = may_differ_ && in_force != stored_;
  if (!unsaved && !memory_.refused) {
    may_differ_ = false;
    retry_.disarm();
    return;
  }
  if (retry_.armed() && !retry_.reached(now)) {
    return;
  }
  retry_.disarm();
  own_action_ = true;
  if (unsaved) {
    begin_saving(in_force, kOwnAttempts);
  } else {
    step_ = Step::Withdraw;
  }
}

void SettingsKeeper::end_own_action(Time now) {
  if (own_action_ && (!saved_ || memory_.refused)) {
    retry_.set(now + kRetry);
  }
  own_action_ = false;
}

}  // namespace ex9000
