#include "tests/world/possible.hpp"

#include <algorithm>
#include <tuple>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/modbus_check.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"

namespace ex9000::world {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr Time kNever = Time::max();
/// The limits of silences are exact to this (wire.md D11).
constexpr microseconds kExact{15};
using reference::kLate;
constexpr milliseconds kReplies{20};
constexpr milliseconds kStores{200};
/// wire.md D15
constexpr milliseconds kRetry{1000};
constexpr milliseconds kModuleWatchdog{1600};
constexpr unsigned kResetByWatchdog = 2;
/// wire.md D13
constexpr milliseconds kInitSettled{10};
constexpr milliseconds kInitTaken{20};
constexpr std::size_t kLongestFrame = 256;
constexpr unsigned kChannels = 16;
/// No module has room for so many frames.
constexpr std::size_t kMostWaiting = 4;

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

/// The time of this many half bits at the present rate.
Time Possible::half_bits(unsigned count) const { return Time(count * 500'000'000ULL / module_.rate()); }

/// From the end of the first stop bit to the end of the last one.
Time Possible::stop_bits_left() const { return half_bits(module_.format() == LineFormat::k8N2 ? 2 : 0); }

/// wire.md D18 and D11: the silence before a reply, and the one that ends a frame of RTU.
Time Possible::gap() const {
  return !module_.runs_modbus()   ? half_bits(2 * reference::character_bits(module_.format()))
         : module_.rate() > 19200 ? Time(microseconds(1750))
                                  : half_bits(77);
}

void Possible::store(const reference::Stored& stored) {
  module_.store(stored);
  saved_ = stored;
}

/// The settings in force are in the memory now.
void Possible::save() {
  older_ = saved_;
  saved_ = module_.stored();
  timeout_unsaved_.reset();
}

std::vector<reference::Stored> Possible::may_be_stored() const {
  std::vector<reference::Stored> all{saved_};
  all.insert(all.end(), ghosts_.begin(), ghosts_.end());
  if (timeout_unsaved_) {
    all.push_back(module_.stored());
  }
  if (first_stores()) {
    reference::Module trial = module_;
    trial.on_frame(waiting_[0].bytes, waiting_[0].bad, {}, overtaken_);
    all.push_back(trial.stored());
  }
  return all;
}

std::vector<Possible> Possible::power_off() const {
  std::vector<Possible> after;
  const std::vector<reference::Stored> all = may_be_stored();
  for (const reference::Stored& stored : all) {
    Possible next = *this;
    next.module_.power(false, {});
    if (!(stored == module_.stored()) || !(stored == saved_)) {
      next.module_.store(stored);
    }
    if (!(stored == saved_)) {
      next.older_ = saved_;
    }
    next.saved_ = stored;
    next.ghosts_.clear();
    if (all.size() > 1) {
      next.module_.doubt_memory();
    }
    for (const reference::Stored& other : all) {
      if (!(other == stored) && next.ghosts_.size() < 2) {
        next.ghosts_.push_back(other);
      }
    }
    next.open_.clear();
    next.bad_.clear();
    next.skipping_ = next.sending_ = next.unreadable_ = next.stores_again_ = next.loads_older_ = false;
    next.hung_.reset();
    next.tick_stopped_.reset();
    next.hangs_until_ = Time::min();
    next.replied_ = Time::min();
    next.overtaken_.reset();
    next.waiting_.clear();
    next.due_.reset();
    next.timeout_unsaved_.reset();
    after.push_back(next);
  }
  return after;
}

void Possible::power_on(Time now) {
  module_.power(true, {now, now + reference::kComingUp});
  start_ = Start::Begins;
  reset_at_ = now;
}

std::vector<Possible> Possible::reset(unsigned reason, Time now) const {
  if (reason == kResetByWatchdog && !hung_ && !tick_stopped_) {
    return {};
  }
  std::vector<Possible> after = power_off();
  for (Possible& next : after) {
    next.power_on(now);
    next.module_.reset({now, now}, reason);
  }
  return after;
}

void Possible::hang(Time time, Time now) {
  if (time == Time(0)) {
    hung_ = now;
  } else {
    hangs_until_ = now + time;
  }
}

void Possible::tick_stops(Time now) { tick_stopped_ = now; }

void Possible::init(bool asserted, Time now) {
  if (init_changes_ && init_changes_->asserted == asserted) {
    return;
  }
  init_changes_.reset();
  if (asserted != module_.init_asserted()) {
    init_changes_ = InitChange{asserted, now};
  }
}

void Possible::memory_fails(bool fails, Time now) { memory_fails_until_ = fails ? kNever : now + kStores; }

// --- frames ---

/// Modbus: whether the open bytes are a frame with a right check.
bool Possible::is_whole() const {
  const auto right_from = [this](std::size_t first) {
    const Bytes frame(open_.begin() + static_cast<std::ptrdiff_t>(first), open_.end());
    return frame.size() >= 4 && frame.size() <= kLongestFrame && reference::crc_is_right(frame) &&
           std::find(bad_.begin() + static_cast<std::ptrdiff_t>(first), bad_.end(), true) == bad_.end();
  };
  return right_from(0) || (open_[0] == 0 && right_from(1));
}

/// Modbus: when the open frame ends, without the uncertainty of the clocks (wire.md D11).
Time Possible::frame_limit() const {
  const unsigned received =
      reference::character_bits(module_.format()) - (module_.format() == LineFormat::k8N2 ? 1 : 0);
  return last_ + stop_bits_left() + gap() + (is_whole() ? Time(0) : half_bits(2 * received));
}

/// The open frame is complete.
std::vector<Possible> Possible::frame_ends(Moment judged) const {
  Possible next = *this;
  const Waiting frame{open_, bad_, last_ + stop_bits_left(), judged};
  next.open_.clear();
  next.bad_.clear();
  const bool concerns = next.module_.on_receipt(frame.bytes, frame.bad, judged);
  const std::string text(frame.bytes.begin(), frame.bytes.end());
  const bool host_ok =
      module_.runs_modbus()
          ? is_whole() && (frame.bytes.size() == 8 || frame.bytes.size() == 9) &&
                reference::word(frame.bytes, frame.bytes.size() - 6) == 0x3038 &&
                (frame.bytes[frame.bytes.size() - 7] == 3 || frame.bytes[frame.bytes.size() - 7] == 4) &&
                reference::word(frame.bytes, frame.bytes.size() - 4) <= 1
          : text.substr(0, 3) == "~**";
  if (concerns && host_ok) {
    next.module_.on_frame(frame.bytes, frame.bad, judged);
  }
  const bool executed = concerns && !host_ok && !hung_;
  // wire.md 8: while a command is executed, at least one more frame is kept. Broadcasts that change
  // nothing need no room.
  const std::size_t others = waiting_.size() + (due_ || sending_ || hangs(judged.earliest) ? 1 : 0);
  const bool may_be_lost = executed && others >= 2;
  std::vector<Possible> received{next};
  // A lost frame need not restart the host watchdog. A main loop that hung may see the end of the timeout
  // later than a frame that came too late.
  const auto& expiry = module_.expiry();
  if (expiry && next.module_.expiry()) {
    if (expiry->latest < judged.earliest) {
      received[0].module_.keep_expiry(*expiry);
    } else if (may_be_lost || expiry->earliest <= judged.latest) {
      received.push_back(next);
      received.back().module_.keep_expiry(*expiry);
    }
  }
  std::vector<Possible> after;
  for (Possible& each : received) {
    if (may_be_lost) {
      after.push_back(each);
      after.back().module_.lose_frame();
    }
    if (executed && others < kMostWaiting) {
      each.waiting_.push_back(frame);
    }
    if (!executed || others < kMostWaiting) {
      after.push_back(each);
    }
  }
  return after;
}

std::vector<Possible> Possible::hear(std::uint8_t byte, bool good, Time end) const {
  Possible next = *this;
  if (!good) {
    next.module_.on_bad_byte();
  }
  if (module_.runs_modbus()) {
    if (next.open_.size() < kLongestFrame + 44) {
      next.open_.push_back(byte);
      next.bad_.push_back(!good);
    }
    next.last_ = end;
    return {next};
  }
  if (open_.empty()) {
    if (!good) {
      return {next};
    }
    if (skipping_) {
      next.skipping_ = byte != '\r';
    } else if (std::string("#$%@~").find(static_cast<char>(byte)) != std::string::npos) {
      next.open_ = {byte};
      next.bad_ = {false};
    } else {
      next.skipping_ = std::string("!>?").find(static_cast<char>(byte)) != std::string::npos;
    }
    return {next};
  }
  next.open_.push_back(byte);
  next.bad_.push_back(!good);
  next.last_ = end;
  if (byte != '\r' || !good) {
    return {next};
  }
  return next.frame_ends({end, end + stop_bits_left() + gap() + kExact});
}

// --- events ---

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
      for (const Possible& next : frame_ends({limit - kExact, limit + kExact})) {
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
        after.push_back(overtaken);
      }
    });
  }
  if (timeout_unsaved_) {
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
  if (due_) {
    return stays && now <= std::max(due_->begins.latest, hangs_until_ + kReplies);
  }
  if (!waiting_.empty() && !sending_) {
    execute(since, now, after);
    stays = stays && now <= first_by(stores_again_ || first_stores());
  }
  return stays;
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
  if (older_) {  // extensions.md: 0x0306 reads 1
    Possible fallen_back = next;
    fallen_back.loads_older_ = fallen_back.stores_again_ = true;
    fallen_back.module_.store(*older_);
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
    if (start_ == Start::Driven && (init_changes_ || init == module_.init_asserted())) {
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

bool Possible::would_store(const Bytes& request) const {
  const std::vector<bool> good(request.size());
  reference::Module trial = module_;
  return module_.powered() && start_ == Start::Over && (module_.runs_modbus() || request.back() == '\r') &&
         reference::Module(module_).on_receipt(request, good, {}) && trial.on_frame(request, good, {}).stores;
}

/// When the reply to the first frame must have begun.
Time Possible::first_by(bool stores) const {
  const Time limit = stores ? Time(kStores) : Time(kReplies);
  return std::max(
             {waiting_[0].judged.latest, free_, hangs_until_, waiting_[0].last + module_.reply_delay()}) +
         limit + (timeout_unsaved_ ? Time(kStores) : Time(0));
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
  const auto done = [&](const reference::Module& module, const reference::Answer& answer, bool stores,
                        bool saves) {
    const Bytes& reply = answer.reply;
    Possible next = *this;
    next.module_ = module;
    next.overtaken_.reset();
    next.waiting_.erase(next.waiting_.begin());
    next.free_ = now;
    if (saves) {
      next.save();
      next.unreadable_ = next.stores_again_ = false;
      next.ghosts_.clear();
    }
    if (!reply.empty()) {
      const Time earliest = module_.runs_modbus() ? first.judged.earliest : first.last + gap() - kExact;
      next.due_ =
          Due{reply,
              answer.refusal,
              {std::max(earliest, first.last + module_.reply_delay()) - microseconds(2), first_by(stores)}};
    }
    after.push_back(next);
  };
  for_each_choice(module_, [&](reference::Module& module) {
    const reference::Answer answer = module.on_frame(first.bytes, first.bad, when, overtaken_);
    done(module, answer, answer.stores, answer.stores);
    const bool stores_again = (stores_again_ || timeout_unsaved_) && answer.sets && !answer.stores;
    if (stores_again) {
      reference::Module again = module;
      again.store_again();
      done(again, answer, true, true);
    }
    if ((answer.stores || stores_again) && memory_fails_until_ >= now) {
      reference::Module refusing = module_;
      const reference::Answer refused = refusing.on_frame_without_store(first.bytes, first.bad, when);
      refusing.doubt_memory();
      done(refusing, refused, true, false);
      after.back().ghosts_.push_back(module.stored());
      after.back().stores_again_ = true;
    }
  });
}

bool Possible::may_be_lit(Time since, Time now) const {
  if (!module_.powered() || start_ != Start::Over || hangs(now) || tick_stopped_) {
    return true;
  }
  // Two flashes every 2 s, or flashes at 2 Hz.
  const Time longest = module_.led_flashes() ? Time(milliseconds(300)) : Time(milliseconds(2100));
  return !(module_.led_flashes() || unreadable_) ||
         now - std::max({since, flashes_since_, hangs_until_}) <= longest;
}

// --- replies ---

std::vector<Possible> Possible::reply(const Bytes& bytes, Time begins) const {
  if (!due_ || due_->bytes != bytes || begins < due_->begins.earliest || begins < replied_ + gap() - kExact ||
      begins > std::max(due_->begins.latest, hangs_until_ + kReplies)) {
    return {};
  }
  Possible next = *this;
  next.due_.reset();
  next.sending_ = true;
  next.skipping_ = false;
  // wire.md D9
  if (module_.runs_modbus() && !open_.empty() && is_whole()) {
    return next.frame_ends({begins, frame_limit() + kExact});
  }
  std::vector<Possible> after{next};
  if (!open_.empty()) {  // wire.md does not say whether the dropped frame counts
    after.push_back(next);
    after.back().module_.count_remains();
  }
  for (Possible& each : after) {
    each.open_.clear();
    each.bad_.clear();
  }
  return after;
}

void Possible::replied(Time end) {
  sending_ = false;
  free_ = replied_ = end;
}

bool Possible::is_like(const Possible& other) const {
  const auto state = [](const Possible& p) {
    return std::tie(p.start_, p.reset_at_, p.open_, p.bad_, p.last_, p.skipping_, p.overtaken_, p.sending_,
                    p.hung_, p.tick_stopped_, p.hangs_until_, p.saved_, p.unreadable_, p.stores_again_,
                    p.ghosts_, p.older_, p.loads_older_, p.memory_fails_until_);
  };
  return state(*this) == state(other) && due_.has_value() == other.due_.has_value() &&
         (!due_ || due_->bytes == other.due_->bytes) &&
         init_changes_.has_value() == other.init_changes_.has_value() &&
         timeout_unsaved_.has_value() == other.timeout_unsaved_.has_value() &&
         std::equal(
             waiting_.begin(), waiting_.end(), other.waiting_.begin(), other.waiting_.end(),
             [](const Waiting& a, const Waiting& b) { return a.bytes == b.bytes && a.bad == b.bad; }) &&
         module_.is_like(other.module_);
}

void Possible::widen(const Possible& other) {
  module_.widen(other.module_);
  if (due_) {
    due_->begins = hull(due_->begins, other.due_->begins);
  }
  if (timeout_unsaved_) {
    timeout_unsaved_ = hull(*timeout_unsaved_, *other.timeout_unsaved_);
  }
  for (std::size_t i = 0; i < waiting_.size(); ++i) {
    waiting_[i].judged = hull(waiting_[i].judged, other.waiting_[i].judged);
    waiting_[i].last = std::min(waiting_[i].last, other.waiting_[i].last);
  }
  free_ = std::max(free_, other.free_);
  flashes_since_ = std::max(flashes_since_, other.flashes_since_);
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
