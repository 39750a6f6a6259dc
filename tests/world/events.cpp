// What a module does by itself, in windows of time: it starts, stores, executes frames, expires.
#include "tests/world/possible.hpp"

#include <algorithm>

#include "tests/world/limits.hpp"

namespace ex9000::world {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr unsigned kChannels = 16;

/// Calls `run` for each combination of choices that `module` has in it.
template <class Run>
void for_each_choice(const reference::Module& module, Run run) {
  std::vector<unsigned> choices;
  do {
    reference::Module trial = module;
    trial.choose(choices);
    run(trial);
    const std::vector<unsigned>& alternatives = trial.alternatives();
    choices.resize(alternatives.size(), 0);
    while (!choices.empty() && ++choices.back() >= alternatives[choices.size() - 1]) {
      choices.pop_back();
    }
  } while (!choices.empty());
}

/// Returns whether the event of `channel` may be the first one of all channels.
template <class Moments>
bool may_be_next(unsigned channel, Moments moment_of) {
  const std::optional<Moment> mine = moment_of(channel);
  bool may = mine.has_value();
  for (unsigned other = 0; may && other < kChannels; ++other) {
    const std::optional<Moment> its = moment_of(other);
    may = !its || !(its->latest < mine->earliest || (*its == *mine && other < channel));
  }
  return may;
}
}  // namespace

bool Possible::futures(Time since, Time now, std::vector<Possible>& after) const {
  bool stays = true;
  const auto happens = [&](Time earliest, Time latest, auto event) {
    if (earliest <= now && now >= hangs_until_) {
      Possible next = *this;
      event(next);
      after.push_back(next);
      stays = stays && (now <= latest || now <= hangs_until_ + kLate);
    }
  };
  if (init_changes_) {
    const Time taken = std::max(init_changes_->when, hangs_until_) + kInitTaken;
    happens(init_changes_->when + kInitSettled, tick_stopped_ ? kNever : taken, [](Possible& next) {
      next.module_.set_init(next.init_changes_->asserted);
      next.init_changes_.reset();
    });
  }
  if (!module_.powered()) {
    return stays;
  }
  if (start_ != Start::Over) {
    stays = stays && (hung_ || now <= std::max(reset_at_, hangs_until_) + reference::kComingUp);
    if (start_ != Start::Driven) {
      come_up(since, now, after);
      return stays;
    }
  }
  if (module_.runs_modbus() && !open_.empty()) {
    const Time limit = frame_limit();
    if (limit - kExact <= now) {
      const Moment judged{limit - kExact, limit + kExact};
      for (const Possible& next : frame_ends(judged, judged)) {
        after.push_back(next);
      }
      stays = stays && now <= limit + kExact;
    }
  }
  if (hung_) {
    return stays && now <= *hung_ + kModuleWatchdog;
  }
  stays = stays && (!tick_stopped_ || now <= std::max(*tick_stopped_, hangs_until_) + kModuleWatchdog);
  if (now < hangs_until_) {
    return stays;
  }
  if (module_.expiry()) {
    happens(module_.expiry()->earliest, module_.expiry()->latest + kLate, [&](Possible& next) {
      next.module_.expire();
      next.flashes_since_ = now;
      next.timeout_unsaved_ = Moment{std::max(since, module_.expiry()->earliest), now};
      if (first_stores() && waiting_[0].judged.earliest <= now) {
        Possible overtaken = next;
        overtaken.overtaken_ = module_.lasting_outputs();
        reference::Module trial = module_;
        trial.on_frame(waiting_[0].bytes, waiting_[0].bad, {});
        overtaken.overtaken_store_ = trial.stored();
        if (first_judged_by() < std::max(since, module_.expiry()->earliest)) {
          next = overtaken;
        } else {
          after.push_back(overtaken);
        }
      }
    });
  }
  if (timeout_unsaved_ && !overtaken_) {
    const Time works = std::max({timeout_unsaved_->latest, memory_fails_until_, hangs_until_});
    const Time retry = memory_fails_until_ > timeout_unsaved_->earliest ? Time(kRetry) : Time(0);
    happens(timeout_unsaved_->earliest, works == kNever ? kNever : works + retry + 2 * kStores,
            [](Possible& next) {
              next.module_.timeout_stored();
              next.save();
            });
  }
  for (unsigned channel = 0; channel < kChannels; ++channel) {
    if (may_be_next(channel, [this](unsigned each) { return module_.end_of_output(each); })) {
      const Moment ends = *module_.end_of_output(channel);
      happens(ends.earliest, ends.latest + kLate,
              [=](Possible& next) { next.module_.end_timed_output(channel); });
    }
    if (may_be_next(channel, [this](unsigned each) { return module_.settling(each); })) {
      const Moment settles = *module_.settling(channel);
      happens(settles.earliest, settles.latest + kLate,
              [=](Possible& next) { next.module_.settle_input(channel); });
    }
  }
  update(since, now, after, stays);
  if (due_) {
    return stays && now <= std::max(due_->begins.latest, hangs_until_ + kReplies);
  }
  if (!waiting_.empty() && !sending_) {
    execute(since, now, after);
    stays = stays && now <= first_by(first_takes());
  }
  return stays;
}

/// What an update does by itself.
void Possible::update(Time since, Time now, std::vector<Possible>& after, bool& stays) const {
  const reference::Update& update = module_.update();
  if (activates_since_ && activates()) {
    stays = stays && (tick_stopped_ || now <= std::max(*activates_since_, hangs_until_) + kActivates);
    if (update.activates) {
      after.push_back(*this);
      after.back().module_.activate_by_itself();
    }
  }
  const bool may_fail = slots_fail_until_ >= since;
  if (may_fail && (update.state == reference::UpdateState::Receiving || update.activates)) {
    after.push_back(*this);
    after.back().module_.fail_update();
  }
  if (update.state == reference::UpdateState::Unconfirmed && start_ == Start::Over) {
    const Moment ends = module_.came_up() + (update.periods + 1) * kProvesItself;
    if (ends.earliest <= now) {
      after.push_back(*this);
      after.back().module_.end_update_period();
      if (may_fail) {
        after.push_back(*this);
        after.back().module_.prolong_update_period();
      }
      if (sending_ && !update.answered) {
        after.push_back(*this);
        after.back().module_.replied();
        after.back().module_.end_update_period();
      }
      stays = stays && (tick_stopped_ || now <= std::max(ends.latest, hangs_until_) + kConfirms);
    }
  }
  if (!before_begin_.empty() && std::max(since, erases_until_) <= now) {
    after.push_back(*this);
    after.back().before_begin_.clear();
    stays = false;
  }
}

/// The inputs begin to count, and later the outputs are driven.
void Possible::come_up(Time since, Time now, std::vector<Possible>& after) const {
  Possible next = *this;
  next.flashes_since_ = now;
  if (start_ == Start::InputsCount) {
    if (now < hangs_until_) {
      return;
    }
    // A failed store leaves a memory that is no longer blank and has no good copy (wire.md D8).
    const bool may_be_unreadable = memory_fails_until_ >= reset_at_ || module_.may_have_spoilt_blank_memory();
    if ((unreadable_ && !may_be_unreadable) || (loads_older_ && memory_fails_until_ < reset_at_)) {
      return;
    }
    if (unreadable_) {
      next.module_.doubt_memory();
    }
    next.start_ = Start::Driven;
    next.module_.started(now);
    after.push_back(next);
    return;
  }
  next.start_ = Start::InputsCount;
  next.module_.reset({std::max(since, reset_at_), now}, module_.reset_reason());
  after.push_back(next);
  for (const reference::Stored& older : older_) {  // extensions.md: 0x0306 reads 1
    Possible fallen_back = next;
    fallen_back.loads_older_ = fallen_back.stores_again_ = true;
    fallen_back.module_.store(older);
    fallen_back.module_.doubt_memory();
    fallen_back.module_.reset({std::max(since, reset_at_), now}, module_.reset_reason());
    after.push_back(fallen_back);
  }
  next.unreadable_ = next.stores_again_ = true;
  next.module_.use_factory_settings();
  next.module_.reset({std::max(since, reset_at_), now}, module_.reset_reason());
  after.push_back(next);
}

std::vector<Possible> Possible::listen(unsigned rate, LineFormat format, Time now) const {
  std::vector<Possible> after;
  for (const bool init : {false, true}) {
    // wire.md D13: INIT* was not stable for 10 ms within 50 ms of the reset.
    const bool may_seem_released = !init && init_changed_ >= reset_at_;
    if (start_ == Start::Driven && (init_changes_ || init == module_.init_asserted() || may_seem_released)) {
      Possible next = *this;
      next.start_ = Start::Over;
      next.free_ = now;
      next.module_.select_mode(init);
      if (next.module_.rate() == rate && next.module_.format() == format) {
        after.push_back(next);
      }
    }
  }
  return after;
}

bool Possible::first_stores() const {
  if (waiting_.empty() || due_ || sending_) {
    return false;
  }
  reference::Module trial = module_;
  return trial.on_frame(waiting_[0].bytes, waiting_[0].bad, {}, overtaken_).stores;
}

/// How long the first frame may take.
Time Possible::first_takes() const {
  reference::Module trial = module_;
  if (waiting_.empty() || due_ || sending_) {
    return kReplies;
  }
  const reference::Answer answer = trial.on_frame(waiting_[0].bytes, waiting_[0].bad, {}, overtaken_);
  return answer.is_block                                     ? Time(kWaitsForErase + kReplies)
         : answer.programs || answer.stores || stores_again_ ? Time(kStores)
                                                             : Time(kReplies);
}

bool Possible::would_store(const Bytes& request) const {
  const std::vector<bool> good(request.size());
  reference::Module trial = module_;
  return module_.powered() && start_ == Start::Over && (module_.runs_modbus() || request.back() == '\r') &&
         reference::Module(module_).on_receipt(request, good, {}) && trial.on_frame(request, good, {}).stores;
}

/// wire.md 8: when the first frame has been judged.
Time Possible::first_judged_by() const {
  return std::max({waiting_[0].judged.latest, free_, hangs_until_}) + kLate;
}

/// When the reply to the first frame must have begun.
Time Possible::first_by(Time takes) const {
  const Time from = std::max({waiting_[0].judged.latest, free_, replied_ + gap(), hangs_until_,
                              waiting_[0].last + module_.reply_delay()});
  return from + takes;
}

void Possible::execute(Time since, Time now, std::vector<Possible>& after) const {
  const Waiting& first = waiting_[0];
  if (first.judged.earliest > now) {
    return;
  }
  const Moment when{std::max({first.judged.earliest, hangs_until_, std::min(since, now)}), now};
  if (module_.expiry() && module_.expiry()->latest < when.earliest) {
    return;  // the host watchdog expires before
  }
  const auto done = [&](const reference::Module& module, const reference::Answer& answer, Time takes,
                        bool saves) {
    const Bytes& reply = answer.reply;
    Possible next = *this;
    next.module_ = module;
    next.overtaken_.reset();
    next.overtaken_store_ = {};
    next.waiting_.erase(next.waiting_.begin());
    next.free_ = now;
    if (saves) {
      next.save();
    }
    if (module.update().starts != module_.update().starts) {
      next.before_begin_.push_back(module_.update());
      next.erases_until_ = slots_fail_until_ >= now ? kNever : now + kErases;
    } else if (answer.programs) {
      next.before_begin_.clear();
    }
    if (!reply.empty()) {
      const Time earliest = module_.runs_modbus() ? first.judged.earliest : first.last + gap() - kExact;
      next.due_ =
          Due{reply,
              answer.refusal,
              {std::max(earliest, first.last + module_.reply_delay()) - microseconds(2), first_by(takes)},
              module.address() != module_.address()};
    }
    after.push_back(next);
    if (saves && overtaken_) {
      next.saved_ = overtaken_store_;
      next.timeout_unsaved_ = when;
      after.push_back(next);
    }
  };
  for_each_choice(module_, [&](reference::Module& module) {
    const reference::Answer answer = module.on_frame(first.bytes, first.bad, when, overtaken_);
    if (answer.programs) {
      done(module, answer, answer.is_block ? Time(kWaitsForErase + kReplies) : Time(kStores), false);
      if (slots_fail_until_ >= first.judged.earliest) {
        reference::Module failing = module_;
        reference::Answer failed = failing.on_frame_without_store(first.bytes, first.bad, when, overtaken_);
        failed.programs = false;
        if (module_.update().state != reference::UpdateState::Unconfirmed) {
          failing.fail_update();
        }
        done(failing, failed, kWaitsForErase + kReplies, false);
      }
      if (!answer.is_block) {
        return;
      }
      reference::Module refusing = module_;
      reference::Answer refused = refusing.on_frame_without_store(first.bytes, first.bad, when, overtaken_);
      refused.programs = false;
      for (const bool goes_on : {false, true}) {  // the block may come into the flash nevertheless
        if (goes_on) {
          refusing.set_update(module.update());
        }
        done(refusing, refused, kWaitsForErase + kReplies, false);
        Due& due = *after.back().due_;
        due.begins.earliest = std::max(due.begins.earliest, first.judged.earliest + kWaitsForErase);
      }
      return;
    }
    if (answer.stores || when.earliest <= first_judged_by()) {
      done(module, answer, answer.stores ? kStores : kReplies, answer.stores);
    }
    const bool stores_again = (stores_again_ || timeout_unsaved_) && answer.sets && !answer.stores;
    if (stores_again) {
      reference::Module again = module;
      again.store_again();
      done(again, answer, kStores, true);
    }
    if ((answer.stores || stores_again) && memory_fails_until_ >= now) {
      reference::Module refusing = module_;
      const reference::Answer refused =
          refusing.on_frame_without_store(first.bytes, first.bad, when, overtaken_);
      refusing.doubt_memory();
      done(refusing, refused, kStores, false);
      after.back().ghosts_.push_back(module.stored());
      after.back().stores_again_ = true;
    }
  });
}

/// wire.md 6: the LED is steady, flashes at 2 Hz, or flashes twice for 0.1 s every 2 s.
bool Possible::may_be_lit(Time since, Time now) const {
  const Time longest = module_.led_flashes() ? milliseconds(300) : milliseconds(150);
  return !led_is_known(now) || !(module_.led_flashes() || unreadable_) ||
         now - std::max({since, flashes_since_, hangs_until_}) <= longest;
}

bool Possible::may_be_dark(Time since, Time now) const {
  const Time longest = module_.led_flashes() ? milliseconds(300)
                       : unreadable_         ? milliseconds(1800)
                                             : milliseconds(20);
  return !led_is_known(now) || now - std::max({since, flashes_since_, free_, hangs_until_}) <= longest;
}

bool Possible::led_is_known(Time now) const {
  return module_.powered() && start_ == Start::Over && !hangs(now) && !tick_stopped_;
}

}  // namespace ex9000::world
