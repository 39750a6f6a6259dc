#include "sim/virtual_line/bus_faults/faults.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "sim/text/durations.hpp"

namespace ex9000::sim {

namespace {

using When = Schedule::When;

/// The foreign station drops a message if at least this many bytes are already waiting.
constexpr std::size_t kMostForeign = 1024;

bool is_of(const Fault& fault, std::size_t module) { return !fault.module || *fault.module == module; }

/// Returns whether a fault of this kind is noise. Noise changes or drops bytes of any station, or adds bytes
/// after them.
bool is_noise(Trouble trouble) {
  return trouble == Trouble::BitErrors || trouble == Trouble::LostBytes ||
         trouble == Trouble::InsertedBytes || trouble == Trouble::StrayZeros;
}

}  // namespace

Faults::Faults(Bus& bus, Master& master, Modules& modules, std::uint64_t seed, Notice notice)
    : bus_(bus),
      end_(bus.attach(*this)),
      master_(master),
      modules_(modules),
      notice_(std::move(notice)),
      chance_(seed) {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    modules_[i]->watch_replies([this, i](std::uint64_t reply) { return reply_begins(i, reply); },
                               [this, i] { reply_ends(i); },
                               [this, i](std::uint64_t reply, bool on) { reply_on_the_wires(i, reply, on); });
    modules_[i]->memory().on_write([this, i] { written(i); });
  }
}

std::size_t Faults::add(const Fault& fault) {
  if (fault.module && *fault.module >= modules_.size()) {
    throw std::invalid_argument(fault.text + ": no module " + std::to_string(*fault.module + 1) +
                                "; expected a position from 1 to " + std::to_string(modules_.size()));
  }
  const VirtualTime now = bus_.clock().virtual_now();
  const Schedule& schedule = fault.schedule;
  Armed armed;
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
  armed.number = ++numbers_;
  armed_.push_back(armed);
  run();
  return armed.number;
}

/// If a fault of this kind requires a station that is not attached yet, attaches this station to the bus.
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
  const auto is_it = [number](const auto& fault) { return fault.number == number; };
  const auto found = std::find_if(armed_.begin(), armed_.end(), is_it);
  const auto ended = std::find_if(ended_.begin(), ended_.end(), is_it);
  if (found != armed_.end()) {
    armed_.erase(found);
  } else if (ended != ended_.end()) {
    ended_.erase(ended);
  } else {
    return false;
  }
  end_effects(number);
  return true;
}

void Faults::remove_all() {
  armed_.clear();
  ended_.clear();
  end_effects(std::nullopt);
}

/// Ends the effects of the removed fault with this number, or of all faults if `removed` is nullopt.
void Faults::end_effects(std::optional<std::size_t> removed) {
  for (const auto& module : modules_) {
    module->end_reply_delays(removed);
  }
  change();
  run();
}

std::vector<Faults::Info> Faults::list() const {
  std::vector<Info> all(ended_.begin(), ended_.end());
  std::transform(armed_.begin(), armed_.end(), std::back_inserter(all),
                 [](const Armed& armed) { return armed.info(); });
  std::sort(all.begin(), all.end(), [](const Info& a, const Info& b) { return a.number < b.number; });
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
    for (const Occurrence& occurrence : armed.occurrences) {
      next = std::min(next, occurrence.ends);
    }
  }
  return next;
}

/// Processes everything that is due: ends occurrences first, then begins new ones, then updates the effects.
void Faults::run() {
  const VirtualTime now = bus_.clock().virtual_now();
  for (Armed& armed : armed_) {
    end_occurrences(armed, [now](const Occurrence& occurrence) { return occurrence.ends <= now; });
  }
  for (Armed& armed : armed_) {
    if (armed.begins <= now) {
      armed.begins =
          armed.fault.schedule.when == When::EveryTime ? armed.begins + armed.fault.schedule.time : kNever;
      begin(armed);
    }
  }
  if (changed_) {
    changed_ = false;
    take_effect();
  }
  put_ended_aside();
  end_.run_at(next());
}

/// Moves the faults that have ended to `ended_`, so that they do not slow the search for active faults.
void Faults::put_ended_aside() {
  const auto ended = std::stable_partition(armed_.begin(), armed_.end(),
                                           [](const Armed& armed) { return !armed.has_ended(); });
  for (auto each = ended; each != armed_.end(); ++each) {
    ended_.push_back(each->info());
    if (ended_.size() > kMostEnded) {
      ended_.pop_front();
    }
  }
  armed_.erase(ended, armed_.end());
}

/// Schedules an update of the effects at the present time. If a module is in the middle of an action, the
/// update follows this action.
void Faults::change() {
  changed_ = true;
  end_.run_at(bus_.clock().virtual_now());
}

/// Begins an occurrence. If a reply has triggered the occurrence, `reply_of` is the module that replies, and
/// `reply` is the number of the reply. Otherwise, `reply_of` is nullopt. A module may cause this call in the
/// middle of an action. This function therefore does not change any module; `run` changes the modules later.
void Faults::begin(Armed& armed, std::optional<std::size_t> reply_of, std::uint64_t reply) {
  const Fault& fault = armed.fault;
  ++armed.occurrences_so_far;
  change();
  say(armed, "occurs");
  if (fault.trouble == Trouble::ForeignTraffic) {
    to_say_.push_back(fault.bytes);
    return;
  }
  if (fault.trouble == Trouble::Hang) {
    for (std::size_t i = 0; i < modules_.size(); ++i) {
      if (is_of(fault, i) && reply_of.value_or(i) == i) {
        hanging_.push_back(i);
      }
    }
    return;
  }
  if (reply_of && is_noise(fault.trouble)) {
    armed.occurrences.push_back({reply_of, kNever, reply, true});
    return;
  }
  const auto lasts = fault.schedule.lasts;
  const VirtualTime ends = lasts ? bus_.clock().virtual_now() + *lasts : kNever;
  for (Occurrence& known : armed.occurrences) {
    if (known.reply_of == reply_of) {
      known.ends = ends;
      return;
    }
  }
  armed.occurrences.push_back({reply_of, ends});
}

/// Ends the occurrences for which `over` returns true.
template <class Over>
void Faults::end_occurrences(Armed& armed, Over over) {
  auto& occurrences = armed.occurrences;
  const auto rest = std::remove_if(occurrences.begin(), occurrences.end(), over);
  if (rest != occurrences.end()) {
    occurrences.erase(rest, occurrences.end());
    change();
    say(armed, "is over");
  }
}

std::size_t Faults::Armed::in_progress() const {
  return static_cast<std::size_t>(
      std::count_if(occurrences.begin(), occurrences.end(),
                    [](const Occurrence& occurrence) { return !occurrence.waits; }));
}

bool Faults::Armed::has_ended() const {
  const bool awaits_writes = fault.schedule.when == When::AfterWrites && counted < fault.schedule.count;
  return occurrences.empty() && begins == kNever && !fault.schedule.of_replies() && !awaits_writes;
}

bool Faults::Armed::occurs_at(std::size_t module) const {
  return is_of(fault, module) &&
         std::any_of(occurrences.begin(), occurrences.end(), [module](const Occurrence& occurrence) {
           return occurrence.reply_of.value_or(module) == module;
         });
}

void Faults::say(const Armed& armed, const std::string& what) const {
  if (notice_ && !armed.fault.schedule.of_replies() && armed.fault.schedule.when != When::Always) {
    notice_("fault " + std::to_string(armed.number) + " " + what + ": " + armed.fault.text);
  }
}

ReplyFate Faults::reply_begins(std::size_t module, std::uint64_t reply) {
  for (Armed& armed : armed_) {
    const Schedule& schedule = armed.fault.schedule;
    if (!schedule.of_replies() || !is_of(armed.fault, module)) {
      continue;
    }
    const bool occurs = schedule.when == When::Probably ? chance_.happens(schedule.probability)
                                                        : ++armed.counted % schedule.count == 0;
    if (occurs) {
      begin(armed, module, reply);
    }
  }
  ReplyFate fate;
  fate.lost = affected_by(Trouble::LostReply, module);
  if (const Armed* late = active(Trouble::LateReply, module)) {
    fate.late_by = late->fault.time;
    fate.delayed_by = late->number;
  }
  return fate;
}

void Faults::reply_ends(std::size_t module) {
  for (Armed& armed : armed_) {
    if (!is_noise(armed.fault.trouble)) {
      end_occurrences(armed, [module](const Occurrence& occurrence) {
        return occurrence.reply_of == module && occurrence.ends == kNever;
      });
    }
  }
}

/// If `on` is true, the reply begins on the wires. The function then begins the noise that this reply has
/// triggered. If `on` is false, the reply has ended or is dropped. The function then ends the noise that this
/// reply has triggered, if the noise has no duration or still waits for the reply.
void Faults::reply_on_the_wires(std::size_t module, std::uint64_t reply, bool on) {
  for (Armed& armed : armed_) {
    if (!is_noise(armed.fault.trouble)) {
      continue;
    }
    const auto of_it = [=](const Occurrence& occurrence) {
      return occurrence.reply_of == module && occurrence.reply == reply && occurrence.ends == kNever;
    };
    if (!on) {
      end_occurrences(armed, of_it);
      continue;
    }
    const auto begun = std::find_if(armed.occurrences.begin(), armed.occurrences.end(), of_it);
    if (begun == armed.occurrences.end()) {
      continue;
    }
    begun->waits = false;
    change();
    if (const auto lasts = armed.fault.schedule.lasts) {
      begun->ends = bus_.clock().virtual_now() + *lasts;
      // Earlier replies of the module may have triggered occurrences that are in progress. The
      // occurrence of this reply ends last, so it replaces them.
      end_occurrences(armed, [=](const Occurrence& occurrence) {
        return occurrence.reply_of == module && occurrence.reply != reply && !occurrence.waits;
      });
    }
  }
  if (on) {
    set_noise();  // before another station begins a byte at the same time
  }
}

void Faults::written(std::size_t module) {
  for (Armed& armed : armed_) {
    const Schedule& schedule = armed.fault.schedule;
    if (schedule.when == When::AfterWrites && is_of(armed.fault, module) &&
        ++armed.counted == schedule.count) {
      begin(armed);
    }
  }
}

/// Returns a fault of this kind that affects the module at present, or null.
const Faults::Armed* Faults::active(Trouble trouble, std::size_t module) const {
  for (const Armed& armed : armed_) {
    if (armed.fault.trouble == trouble && armed.occurs_at(module)) {
      return &armed;
    }
  }
  return nullptr;
}

void Faults::take_effect() {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    modules_[i]->interrupt_supply(affected_by(Trouble::Gone, i) || affected_by(Trouble::PowerCut, i));
    const Armed* const wrong = active(Trouble::WrongRate, i);
    modules_[i]->force_rate(wrong == nullptr ? 0 : wrong->fault.baud);
    const Armed* const late = active(Trouble::LateDriver, i);
    modules_[i]->release_driver_late(late == nullptr ? VirtualTime(0) : late->fault.time);
  }
  for (const std::size_t module : std::exchange(hanging_, {})) {
    modules_[module]->hang();
  }
  set_noise();
  set_echo();
  for (const auto& bytes : std::exchange(to_say_, {})) {
    stranger_->set_mode(master_.mode());
    if (stranger_->waiting() < kMostForeign) {
      stranger_->send(bytes.data(), bytes.size());
    }
  }
}

/// Returns the highest probability of the faults of this kind that are in progress; 0 if there is none.
double Faults::rate_of(Trouble trouble) const {
  double rate = 0;
  for (const Armed& armed : armed_) {
    if (armed.in_progress() != 0 && armed.fault.trouble == trouble) {
      rate = std::max(rate, armed.fault.probability);
    }
  }
  return rate;
}

void Faults::set_noise() {
  if (!noise_) {
    return;
  }
  NoiseRates rates;
  rates.flipped_bit = rate_of(Trouble::BitErrors);
  rates.lost_character = rate_of(Trouble::LostBytes);
  rates.stray_character = rate_of(Trouble::InsertedBytes);
  rates.stray_zero = rate_of(Trouble::StrayZeros);
  noise_->set_rates(rates);
}

void Faults::set_echo() {
  const auto armed = std::find_if(armed_.begin(), armed_.end(), [](const Armed& each) {
    return each.fault.trouble == Trouble::Echo && each.in_progress() != 0;
  });
  if (armed != armed_.end()) {
    echo_->switch_on(armed->fault.time);
  } else if (echo_) {
    echo_->switch_off();
  }
}

}  // namespace ex9000::sim
