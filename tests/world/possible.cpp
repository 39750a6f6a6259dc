// What a module keeps, loses and loads, and which states are alike.
#include "tests/world/possible.hpp"

#include <algorithm>
#include <tuple>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/world/limits.hpp"

namespace ex9000::world {

namespace {

/// Returns whether that adds anything.
bool add_missing(std::vector<reference::Stored>& to, const std::vector<reference::Stored>& from) {
  const std::size_t before = to.size();
  for (const reference::Stored& each : from) {
    if (std::find(to.begin(), to.end(), each) == to.end()) {
      to.push_back(each);
    }
  }
  return to.size() != before;
}

}  // namespace

void Possible::store(const reference::Stored& stored) {
  module_.store(stored);
  saved_ = stored;
}

/// The settings in force are in the memory now.
void Possible::save() {
  older_ = {saved_};
  saved_ = module_.stored();
  timeout_unsaved_.reset();
  unreadable_ = stores_again_ = false;
  ghosts_.clear();
}

std::vector<reference::Stored> Possible::may_be_stored() const {
  std::vector<reference::Stored> all{saved_};
  add_missing(all, ghosts_);
  if (timeout_unsaved_) {
    add_missing(all, {module_.stored()});
  }
  if (first_stores()) {
    reference::Module trial = module_;
    trial.on_frame(waiting_[0].bytes, waiting_[0].bad, {}, overtaken_);
    add_missing(all, {trial.stored()});
    if (overtaken_) {
      add_missing(all, {overtaken_store_});
    }
  }
  return all;
}

/// What the slots may hold at the next start, if this state ends now.
std::vector<reference::Update> Possible::after_reset() const {
  std::vector<reference::Update> all;
  const auto add = [&all](const reference::Update& update) {
    reference::Update then = update.after_reset();
    const auto take = [&] {
      if (std::find(all.begin(), all.end(), then) == all.end()) {
        all.push_back(then);
      }
    };
    take();
    if (then.state == reference::UpdateState::Complete && then.spare.activates_when_complete()) {
      // The specification does not say whether an activation that a reset has prevented comes afterwards.
      then.activates = true;
      take();
    }
  };
  const auto may_be = [&add](const reference::Update& update) {
    if (update.state != reference::UpdateState::Failed) {
      add(update);
      return;
    }
    add(update.erased());  // or what the failed flash still has
    if (!update.spare.begin.empty()) {
      reference::Update kept = update;
      kept.state = reference::UpdateState::Receiving;
      add(kept);
      if (update.spare.size() >= update.spare.length()) {
        kept.state = reference::UpdateState::Complete;
        add(kept);
      }
    }
  };
  const reference::Update& now = module_.update();
  const auto may_begin_from = [&](const reference::Update& before) {
    may_be(before);
    may_be(before.erased());
  };
  may_be(now);
  if (now.activates) {
    reference::Module activating = module_;
    activating.activate_by_itself();
    may_be(activating.update());
  }
  if (now.state == reference::UpdateState::Unconfirmed && start_ != Start::Over) {
    all.push_back(now);  // perhaps it has not had its chance
  }
  for (const reference::Update& before : before_begin_) {
    may_begin_from(before);
  }
  if (!waiting_.empty() && !due_ && !sending_) {
    reference::Module trial = module_;
    trial.on_frame(waiting_[0].bytes, waiting_[0].bad, {}, overtaken_);
    const reference::Update& then = trial.update();
    may_be(then);
    if (then.starts != now.starts) {
      may_begin_from(now);
    }
    if (then.activates) {
      trial.activate_by_itself();
      may_be(trial.update());
    }
  }
  return all;
}

/// The module is about to reset into the new image.
bool Possible::activates() const {
  return module_.update().activates || module_.update().state == reference::UpdateState::Pending;
}

std::vector<Possible> Possible::power_off() const {
  std::vector<Possible> after;
  const std::vector<reference::Stored> all = may_be_stored();
  const std::vector<reference::Update> updates = after_reset();
  for (const reference::Stored& stored : all) {
    Possible next = *this;
    next.module_.power(false, {});
    if (!(stored == module_.stored()) || !(stored == saved_)) {
      next.module_.store(stored);
    }
    if (!(stored == saved_)) {
      add_missing(next.older_, {saved_});
    }
    next.saved_ = stored;
    next.ghosts_ = all;
    if (all.size() > 1) {
      next.module_.doubt_memory();
    }
    next.open_.clear();
    next.bad_.clear();
    next.skipping_ = next.sending_ = next.unreadable_ = next.stores_again_ = next.loads_older_ = false;
    next.hung_.reset();
    next.tick_stopped_.reset();
    next.hangs_until_ = Time::min();
    next.replied_ = Time::min();
    next.overtaken_.reset();
    next.overtaken_store_ = {};
    next.waiting_.clear();
    next.due_.reset();
    next.timeout_unsaved_.reset();
    next.before_begin_.clear();
    next.erases_until_ = Time::min();
    for (const reference::Update& update : updates) {
      next.module_.set_update(update);
      next.activates_since_ = update.activates ? std::optional(kSometime) : std::nullopt;
      after.push_back(next);
    }
  }
  return after;
}

void Possible::power_on(Time now) {
  module_.power(true, {now, now + reference::kComingUp});
  start_ = Start::Begins;
  reset_at_ = now;
  if (images_are_bad_ && module_.update().state == reference::UpdateState::Unconfirmed) {
    hung_ = now;
  }
}

std::vector<Possible> Possible::reset(unsigned reason, Time now) const {
  if (reason == kResetByWatchdog && !hung_ && !tick_stopped_) {
    return {};
  }
  if (reason == kResetByUpdate && (hung_ || now < hangs_until_ || !activates_since_ || !activates())) {
    return {};
  }
  // wire.md 2: a life of 60 s ends the row. The main loop counts it, at the latest with the next tick.
  const Time lived = (hung_ ? *hung_ : now) - reset_at_;
  const bool may_be_in_a_row = lived <= kEndsTheRow + kNoticesIt;
  const bool may_be_new = lived >= kEndsTheRow;
  std::vector<Possible> after;
  for (const bool in_a_row : {false, true}) {
    if (reason == kResetByWatchdog && !(in_a_row ? may_be_in_a_row : may_be_new)) {
      continue;
    }
    Possible before = *this;
    if (reason == kResetByUpdate && module_.update().activates) {
      before.module_.activate_by_itself();
    }
    for (Possible next : before.power_off()) {
      const unsigned crashes = in_a_row ? std::min(module_.crashes(), 2U) : 0;
      next.power_on(now);
      next.module_.set_crashes(reason == kResetByWatchdog ? crashes + 1 : 0);
      next.module_.reset({now, now}, reason);
      after.push_back(next);
    }
    if (reason != kResetByWatchdog) {
      break;
    }
  }
  return after;
}

void Possible::hang(Time time, Time now) {
  if (time == Time(0)) {
    hung_ = now;
  } else {
    hangs_until_ = now + time;
    erases_until_ += erases_until_ == kNever ? Time(0) : time;
  }
}

void Possible::tick_stops(Time now) { tick_stopped_ = now; }

void Possible::init(bool asserted, Time now) {
  init_changed_ = now;
  if (init_changes_ && init_changes_->asserted == asserted) {
    return;
  }
  init_changes_.reset();
  if (asserted != module_.init_asserted()) {
    init_changes_ = InitChange{asserted, now};
  }
}

void Possible::memory_fails(bool fails, Time now) {
  if (fails || memory_fails_until_ == kNever) {
    memory_fails_until_ = fails ? kNever : now + kStores;
  }
}

/// What the flash has not taken by then may be noticed later.
void Possible::slots_fail(bool fails, Time now) {
  if (fails || slots_fail_until_ == kNever) {
    slots_fail_until_ = fails ? kNever : now + kErases;
  }
  if (fails) {
    erases_until_ = kNever;  // the flash may keep what it has, until it takes something else
  }
}

bool Possible::is_like(const Possible& other) const {
  const auto state = [](const Possible& p) {
    return std::tie(p.start_, p.reset_at_, p.open_, p.bad_, p.last_, p.skipping_, p.overtaken_,
                    p.overtaken_store_, p.sending_, p.hung_, p.tick_stopped_, p.hangs_until_, p.saved_,
                    p.unreadable_, p.stores_again_, p.loads_older_, p.memory_fails_until_, p.before_begin_);
  };
  return state(*this) == state(other) && due_.has_value() == other.due_.has_value() &&
         (!due_ || due_->bytes == other.due_->bytes) &&
         init_changes_.has_value() == other.init_changes_.has_value() &&
         timeout_unsaved_.has_value() == other.timeout_unsaved_.has_value() &&
         activates_since_.has_value() == other.activates_since_.has_value() &&
         std::equal(
             waiting_.begin(), waiting_.end(), other.waiting_.begin(), other.waiting_.end(),
             [](const Waiting& a, const Waiting& b) { return a.bytes == b.bytes && a.bad == b.bad; }) &&
         module_.is_like(other.module_);
}

bool Possible::widen(const Possible& other) {
  bool changed = module_.widen(other.module_);
  const auto cover = [&](Moment& mine, const Moment& its) {
    changed = reference::widen(mine, its) || changed;
  };
  const auto take_later = [&](Time& mine, Time its) {
    changed = changed || mine < its;
    mine = std::max(mine, its);
  };
  changed = add_missing(ghosts_, other.ghosts_) || changed;
  changed = add_missing(older_, other.older_) || changed;
  if (due_) {
    cover(due_->begins, other.due_->begins);
  }
  if (timeout_unsaved_) {
    cover(*timeout_unsaved_, *other.timeout_unsaved_);
  }
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    cover(waiting_[i].judged, other.waiting_[i].judged);
    changed = changed || other.waiting_[i].last < waiting_[i].last;
    waiting_[i].last = std::min(waiting_[i].last, other.waiting_[i].last);
  }
  if (activates_since_) {
    take_later(*activates_since_, *other.activates_since_);
  }
  take_later(erases_until_, other.erases_until_);
  take_later(free_, other.free_);
  take_later(flashes_since_, other.flashes_since_);
  return changed;
}

std::string Possible::text() const {
  std::string text = "outputs " + reference::hex(outputs(), 4);
  if (!module_.powered()) {
    return text + ", no power";
  }
  if (start_ != Start::Over) {
    text += ", starts";
  }
  text += std::string(unreadable_ ? ", settings unreadable" : "") + (stores_again_ ? ", stores again" : "") +
          (timeout_unsaved_ ? ", timeout not stored" : "") + (overtaken_ ? ", command overtaken" : "");
  if (module_.stored().timed_out) {
    text += ", timeout status";
  }
  if (module_.expiry()) {
    text += ", expires " + std::to_string(module_.expiry()->earliest.count()) + " to " +
            std::to_string(module_.expiry()->latest.count());
  }
  constexpr const char* kUpdates[] = {
      "", ", receives", ", complete", ", activates", ", not confirmed", ", taken back", ", flash failed"};
  const reference::Update& update = module_.update();
  text += kUpdates[static_cast<unsigned>(update.state)];
  if (update.state == reference::UpdateState::Receiving) {
    text += " " + std::to_string(update.spare.size()) + " of " + std::to_string(update.spare.length());
  }
  text += std::string(update.activates ? ", activates soon" : "") + (update.answered ? ", answered" : "");
  if (module_.update().running.version() != 0x0100) {
    text += ", version " + reference::hex(update.running.version(), 4);
  }
  for (const std::uint8_t byte : open_) {
    text += (&byte == open_.data() ? ", open " : "") + reference::hex(byte, 2);
  }
  for (const Waiting& frame : waiting_) {
    text += ", waits ";
    for (const std::uint8_t byte : frame.bytes) {
      text += reference::hex(byte, 2);
    }
    text += " judged " + std::to_string(frame.judged.earliest.count());
  }
  if (due_) {
    text += ", replies ";
    for (const std::uint8_t byte : due_->bytes) {
      text += reference::hex(byte, 2);
    }
    text += " at " + std::to_string(due_->begins.earliest.count()) + " to " +
            std::to_string(due_->begins.latest.count()) +
            (due_->refusal.empty() ? "" : " (" + due_->refusal + ")");
  }
  return text + (sending_ ? ", sends" : "") + (hung_ ? ", hangs" : "") + (skipping_ ? ", skips" : "");
}

}  // namespace ex9000::world
