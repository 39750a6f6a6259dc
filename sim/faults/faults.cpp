#include "sim/faults/faults.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/text/durations.hpp"

namespace ex9000::sim {

namespace {

using When = Schedule::When;

/// The foreign station drops a message if this many bytes are already waiting.
constexpr std::size_t kMostForeign = 1024;

bool is_of(const Fault& fault, std::size_t module) { return !fault.module || *fault.module == module; }

/// Returns whether the fault is noise, which affects the wires, regardless of the sender.
bool is_noise(Trouble trouble) {
  return trouble == Trouble::BitErrors || trouble == Trouble::LostBytes ||
         trouble == Trouble::InsertedBytes || trouble == Trouble::StrayZeros;
}

/// Returns whether the fault has no duration.
bool is_a_moment(Trouble trouble) { return trouble == Trouble::ForeignTraffic || trouble == Trouble::Hang; }

}  // namespace

Faults::Faults(Bus& bus, Master& master, Modules& modules, std::uint64_t seed, Notice notice)
    : bus_(bus),
      end_(bus.attach(*this)),
      master_(master),
      modules_(modules),
      notice_(std::move(notice)),
      chance_(seed),
      replies_(modules.size()) {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    modules_[i]->watch_replies([this, i] { return reply_begins(i); }, [this, i] { reply_ends(i); },
                               [this, i](std::uint64_t reply, bool on) { reply_on_the_wires(i, reply, on); });
    modules_[i]->memory().on_write([this, i] { written(i); });
  }
}

std::size_t Faults::add(const Fault& fault) {
  if (fault.module && *fault.module >= modules_.size()) {
    throw std::invalid_argument(fault.text + ": no module " + std::to_string(*fault.module + 1) +
                                "; this line has 1 to " + std::to_string(modules_.size()));
  }
  const VirtualTime now = bus_.clock().virtual_now();
  const Schedule& schedule = fault.schedule;
  Armed armed;
  armed.number = numbers_ + 1;
  armed.fault = fault;
  if (schedule.when == When::Always) {
    armed.begins = now;
  } else if (schedule.when == When::At) {
    if (schedule.time < now) {
      throw std::invalid_argument(fault.text + ": the time has passed; expected a time from " +
                                  time_text(now) + " on");
    }
    armed.begins = schedule.time;
  } else if (schedule.when == When::EveryTime) {
    armed.begins = now + schedule.time;
  }
  prepare(fault.trouble);
  ++numbers_;
  armed_.push_back(armed);
  act();
  return numbers_;
}

/// Attaches only the stations that the fault requires.
void Faults::prepare(Trouble trouble) {
  if (is_noise(trouble) && !noise_) {
    noise_ = std::make_unique<Noise>(bus_, NoiseRates(), chance_.number());
  } else if (trouble == Trouble::Echo && !echo_) {
    echo_ = std::make_unique<Echo>(bus_, master_.mode());
    master_.on_mode([this](SerialMode mode) { echo_->set_mode(mode); });
  } else if (trouble == Trouble::ForeignTraffic && !stranger_) {
    stranger_ =
        std::make_unique<Master>(bus_, master_.mode(), [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  }
}

bool Faults::remove(std::size_t number) {
  const auto found =
      std::find_if(armed_.begin(), armed_.end(), [=](const Armed& armed) { return armed.number == number; });
  if (found == armed_.end()) {
    return false;
  }
  const bool was_late = found->fault.trouble == Trouble::LateReply;
  armed_.erase(found);
  if (was_late) {
    release_late_replies();
  }
  change();
  act();
  return true;
}

void Faults::remove_all() {
  armed_.clear();
  release_late_replies();
  change();
  act();
}

void Faults::release_late_replies() {
  for (const auto& module : modules_) {
    module->release_late_replies();
  }
}

std::vector<Faults::Info> Faults::list() const {
  std::vector<Info> all;
  for (const Armed& armed : armed_) {
    all.push_back(
        {armed.number, armed.fault.text, armed.fault.module, armed.strikes_now(), armed.strikes_so_far});
  }
  return all;
}

bool Faults::pending() const {
  return changed_ || (echo_ && echo_->sending()) || (stranger_ && stranger_->sending());
}

VirtualTime Faults::next() const {
  if (changed_) {
    return bus_.clock().virtual_now();
  }
  VirtualTime next = kNever;
  for (const Armed& armed : armed_) {
    next = std::min(next, armed.begins);
    for (const Strike& strike : armed.strikes) {
      next = std::min(next, strike.ends);
    }
  }
  return next;
}

void Faults::run() { act(); }

/// Processes everything that is due: ends strikes first, then begins new ones.
void Faults::act() {
  const VirtualTime now = bus_.clock().virtual_now();
  for (Armed& armed : armed_) {
    end_strikes(armed, [now](const Strike& strike) { return strike.ends <= now; });
  }
  for (Armed& armed : armed_) {
    if (armed.begins <= now) {
      armed.begins =
          armed.fault.schedule.when == When::EveryTime ? armed.begins + armed.fault.schedule.time : kNever;
      strike(armed, std::nullopt);
    }
  }
  if (changed_) {
    changed_ = false;
    take_effect();
  }
  end_.run_at(next());
}

/// Requests that the effects are updated as soon as the modules have finished their present actions.
void Faults::change() {
  changed_ = true;
  end_.run_at(bus_.clock().virtual_now());
}

/// Begins a strike. A module may cause this call during its work; therefore this function does not change
/// the modules. The next call of `act` applies the strike.
void Faults::strike(Armed& armed, std::optional<std::size_t> reply_of) {
  const Fault& fault = armed.fault;
  ++armed.strikes_so_far;
  change();
  say(armed, "strikes");
  if (fault.trouble == Trouble::ForeignTraffic) {
    to_say_.push_back(fault.bytes);
  }
  if (fault.trouble == Trouble::Hang) {
    for (std::size_t i = 0; i < modules_.size(); ++i) {
      // A strike on a reply affects its sender; any other strike affects all modules of the fault.
      if (is_of(fault, i) && reply_of.value_or(i) == i) {
        hanging_.push_back(i);
      }
    }
  }
  if (is_a_moment(fault.trouble)) {
    return;
  }
  auto lasts = fault.schedule.lasts;
  if (!lasts && fault.trouble == Trouble::PowerCut) {
    lasts = kPowerCutLasts;
  }
  if (reply_of && is_noise(fault.trouble)) {
    armed.strikes.push_back({reply_of, kNever, replies_[*reply_of], true});
    return;
  }
  const VirtualTime ends = lasts ? bus_.clock().virtual_now() + *lasts : kNever;
  for (Strike& known : armed.strikes) {
    if (known.reply_of == reply_of) {
      known.ends = ends;
      return;
    }
  }
  armed.strikes.push_back({reply_of, ends});
}

/// Ends the strikes for which `over` is true.
template <class Over>
void Faults::end_strikes(Armed& armed, Over over) {
  auto& strikes = armed.strikes;
  const auto rest = std::remove_if(strikes.begin(), strikes.end(), over);
  if (rest != strikes.end()) {
    strikes.erase(rest, strikes.end());
    change();
    say(armed, "is over");
  }
}

std::size_t Faults::Armed::strikes_now() const {
  return static_cast<std::size_t>(
      std::count_if(strikes.begin(), strikes.end(), [](const Strike& strike) { return !strike.waits; }));
}

bool Faults::Armed::strikes_module(std::size_t module) const {
  return is_of(fault, module) && std::any_of(strikes.begin(), strikes.end(), [module](const Strike& strike) {
           return strike.reply_of.value_or(module) == module;
         });
}

void Faults::say(const Armed& armed, const std::string& what) const {
  if (notice_ && !armed.fault.schedule.of_replies() && armed.fault.schedule.when != When::Always) {
    notice_("fault " + std::to_string(armed.number) + " " + what + ": " + armed.fault.text);
  }
}

/// Removes earlier strikes on replies of the same module, because the latest one lasts longer.
void Faults::forget_others_of(Armed& armed, const Strike& latest) {
  const Strike kept = latest;
  auto& strikes = armed.strikes;
  strikes.erase(std::remove_if(strikes.begin(), strikes.end(),
                               [&kept](const Strike& strike) {
                                 return strike.reply_of == kept.reply_of && !strike.waits &&
                                        strike.reply != kept.reply;
                               }),
                strikes.end());
}

ReplyFate Faults::reply_begins(std::size_t module) {
  ++replies_[module];
  for (Armed& armed : armed_) {
    const Schedule& schedule = armed.fault.schedule;
    if (!schedule.of_replies() || !is_of(armed.fault, module)) {
      continue;
    }
    const bool strikes = schedule.when == When::Probably ? chance_.happens(schedule.probability)
                                                         : ++armed.counted % schedule.count == 0;
    if (strikes) {
      strike(armed, module);
    }
  }
  if (changed_) {
    set_late_drivers();
  }
  ReplyFate fate;
  fate.lost = struck_by(Trouble::LostReply, module);
  if (fate.lost) {
    reply_on_the_wires(module, replies_[module], false);
  }
  if (const Fault* late = striking(Trouble::LateReply, module)) {
    fate.late_by = late->time;
  }
  return fate;
}

void Faults::reply_ends(std::size_t module) {
  for (Armed& armed : armed_) {
    if (!is_noise(armed.fault.trouble)) {
      end_strikes(armed, [module](const Strike& strike) {
        return strike.reply_of == module && strike.ends == kNever;
      });
    }
  }
}

/// Begins noise with the first bit of this reply, even if the reply is late. Noise without a duration ends
/// with the reply.
void Faults::reply_on_the_wires(std::size_t module, std::uint64_t reply, bool on) {
  for (Armed& armed : armed_) {
    if (!is_noise(armed.fault.trouble)) {
      continue;
    }
    const auto of_it = [=](const Strike& strike) {
      return strike.reply_of == module && strike.reply == reply && strike.ends == kNever;
    };
    if (!on) {
      end_strikes(armed, of_it);
      continue;
    }
    const auto strike = std::find_if(armed.strikes.begin(), armed.strikes.end(), of_it);
    if (strike != armed.strikes.end()) {
      strike->waits = false;
      if (const auto lasts = armed.fault.schedule.lasts) {
        strike->ends = bus_.clock().virtual_now() + *lasts;
        forget_others_of(armed, *strike);
      }
    }
  }
  if (on) {
    set_noise();
  }
}

void Faults::written(std::size_t module) {
  for (Armed& armed : armed_) {
    const Schedule& schedule = armed.fault.schedule;
    if (schedule.when == When::AfterWrites && is_of(armed.fault, module) &&
        ++armed.counted == schedule.count) {
      strike(armed, std::nullopt);
    }
  }
}

/// Returns a fault of this kind that affects the module at present, or null. A strike on a module's reply
/// affects only that module.
const Fault* Faults::striking(Trouble trouble, std::size_t module) const {
  for (const Armed& armed : armed_) {
    if (armed.fault.trouble == trouble && armed.strikes_module(module)) {
      return &armed.fault;
    }
  }
  return nullptr;
}

const Fault* Faults::striking_the_line(Trouble trouble) const {
  for (const Armed& armed : armed_) {
    if (armed.strikes_now() != 0 && armed.fault.trouble == trouble) {
      return &armed.fault;
    }
  }
  return nullptr;
}

void Faults::take_effect() {
  set_powers();
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const Fault* const wrong = striking(Trouble::WrongRate, i);
    modules_[i]->force_rate(wrong == nullptr ? 0 : wrong->baud);
  }
  set_late_drivers();
  for (const std::size_t module : std::exchange(hanging_, {})) {
    modules_[module]->hang();
  }
  set_noise();
  set_echo();
  for (const auto& bytes : std::exchange(to_say_, {})) {
    say_foreign(bytes);
  }
}

void Faults::set_powers() {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    modules_[i]->interrupt_supply(struck_by(Trouble::Gone, i) || struck_by(Trouble::PowerCut, i));
  }
}

void Faults::set_late_drivers() {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    const Fault* const late = striking(Trouble::LateDriver, i);
    modules_[i]->release_driver_late(late == nullptr ? VirtualTime(0) : late->time);
  }
}

/// Returns the highest probability of the faults in progress.
double Faults::rate_of(Trouble trouble) const {
  double rate = 0;
  for (const Armed& armed : armed_) {
    if (armed.strikes_now() != 0 && armed.fault.trouble == trouble) {
      rate = std::max(rate, armed.fault.probability);
    }
  }
  return rate;
}

void Faults::set_noise() {
  NoiseRates rates;
  rates.flipped_bit = rate_of(Trouble::BitErrors);
  rates.lost_character = rate_of(Trouble::LostBytes);
  rates.stray_character = rate_of(Trouble::InsertedBytes);
  rates.stray_zero = rate_of(Trouble::StrayZeros);
  if (noise_) {
    noise_->set_rates(rates);
  }
}

void Faults::set_echo() {
  const Fault* const fault = striking_the_line(Trouble::Echo);
  if (!echo_) {
    return;
  }
  if (fault == nullptr) {
    echo_->switch_off();
  } else {
    echo_->switch_on(fault->time);
  }
}

void Faults::say_foreign(const std::vector<std::uint8_t>& bytes) {
  stranger_->set_mode(master_.mode());
  if (stranger_->waiting() < kMostForeign) {
    stranger_->send(bytes.data(), bytes.size());
  }
}

}  // namespace ex9000::sim
