#include "sim/virtual_line/faults/faults.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using When = Schedule::When;

/// The foreign station drops a message if this many bytes already wait.
constexpr std::size_t kMostForeign = 1024;

}  // namespace

Faults::Faults(Wires& wires, Master& master, Modules& modules, std::uint64_t seed, Notice notice)
    : wires_(wires),
      end_(wires.attach(*this)),
      modules_(modules),
      notice_(std::move(notice)),
      chance_(seed),
      noise_(wires, NoiseRates(), chance_.number()),
      echo_(wires, master.mode()),
      stranger_(wires, master.mode(), [](std::uint8_t /*byte*/, ByteStatus /*status*/) {}) {
  master.on_mode([this](SerialMode mode) {
    echo_.set_mode(mode);
    stranger_.set_mode(mode);
  });
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    modules_[i]->watch_replies(
        [this, i](Reply& reply) { reply_begins(i, reply); },
        [this, i] {
          end_where([i](std::size_t place, VirtualTime ends) { return place == i && ends == kNever; });
        });
    modules_[i]->memory().on_write([this, i] { written(i); });
  }
}

std::size_t Faults::add(Fault fault) {
  if (fault.module && *fault.module >= modules_.size()) {
    fail(fault.text + ": no module " + std::to_string(*fault.module + 1) +
         "; expected a position from 1 to " + std::to_string(modules_.size()));
  }
  const VirtualTime now = wires_.clock().virtual_now();
  const Schedule& schedule = fault.schedule;
  if (schedule.when == When::At && schedule.time < now) {
    fail(fault.text + ": the time has passed; expected a time from " + time_text(now) + " on");
  }
  const VirtualTime begins = schedule.when == When::Always      ? now
                             : schedule.when == When::At        ? schedule.time
                             : schedule.when == When::EveryTime ? now + schedule.time
                                                                : kNever;
  fault.number = ++numbers_;
  scheduled_.push_back({std::move(fault), begins});
  run();
  return numbers_;
}

bool Faults::remove(std::size_t number) {
  const auto found = std::find_if(scheduled_.begin(), scheduled_.end(), [number](const Scheduled& scheduled) {
    return scheduled.fault.number == number;
  });
  if (found == scheduled_.end()) {
    return false;
  }
  scheduled_.erase(found);
  for (const auto& module : modules_) {
    module->end_reply_delays(number);
  }
  change();
  run();
  return true;
}

void Faults::remove_all() {
  while (!scheduled_.empty()) {
    remove(scheduled_.back().fault.number);
  }
}

std::vector<Faults::Info> Faults::list() const {
  std::vector<Info> all;
  for (const auto& [fault, begins, active, counted, occurrences] : scheduled_) {
    all.push_back({fault.number, fault.text, fault.module, active.size(), occurrences});
  }
  return all;
}

/// Ends occurrences first, then begins new ones, then updates the effects.
void Faults::run() {
  const VirtualTime now = wires_.clock().virtual_now();
  end_where([now](std::size_t /*place*/, VirtualTime ends) { return ends <= now; });
  for (Scheduled& scheduled : scheduled_) {
    if (scheduled.begins <= now) {
      const Schedule& schedule = scheduled.fault.schedule;
      scheduled.begins = schedule.when == When::EveryTime ? scheduled.begins + schedule.time : kNever;
      begin(scheduled, kEverywhere);
    }
  }
  if (std::exchange(changed_, false)) {
    take_effect();
  }
  const auto has_ended = std::mem_fn(&Scheduled::has_ended);
  while (std::count_if(scheduled_.begin(), scheduled_.end(), has_ended) > kMostEnded) {
    scheduled_.erase(std::find_if(scheduled_.begin(), scheduled_.end(), has_ended));
  }
  VirtualTime next = changed_ ? now : kNever;  // a module may have caused a change above
  for (const Scheduled& scheduled : scheduled_) {
    next = std::min(next, scheduled.begins);
    for (const auto& [place, ends] : scheduled.active) {
      next = std::min(next, ends);
    }
  }
  end_.run_at(next);
}

/// Has `run` update the effects now, but after the action that a module may be in.
void Faults::change() {
  changed_ = true;
  end_.run_at(wires_.clock().virtual_now());
}

/// `place`: the module whose reply triggers the occurrence, or kEverywhere. A module may call this in the
/// middle of an action, so only `run` changes modules.
void Faults::begin(Scheduled& scheduled, std::size_t place) {
  const auto lasts = scheduled.fault.schedule.lasts;
  scheduled.active[place] = lasts ? wires_.clock().virtual_now() + *lasts : kNever;
  ++scheduled.occurrences_so_far;
  change();
  say(scheduled, "occurs");
}

template <class Over>
void Faults::end_where(Over over) {
  for (Scheduled& scheduled : scheduled_) {
    auto& active = scheduled.active;
    const std::size_t before = active.size();
    for (auto each = active.begin(); each != active.end();) {
      each = over(each->first, each->second) ? active.erase(each) : std::next(each);
    }
    if (active.size() != before) {
      change();
      say(scheduled, "is over");
    }
  }
}

bool Faults::Scheduled::has_ended() const {
  const bool awaits_writes = fault.schedule.when == When::AfterWrites && counted < fault.schedule.count;
  return active.empty() && begins == kNever && !fault.schedule.of_replies() && !awaits_writes;
}

void Faults::say(const Scheduled& scheduled, const std::string& what) const {
  const Fault& fault = scheduled.fault;
  if (notice_ && !fault.schedule.of_replies() && fault.schedule.when != When::Always) {
    notice_("fault " + std::to_string(fault.number) + " " + what + ": " + fault.text);
  }
}

void Faults::reply_begins(std::size_t module, Reply& reply) {
  for (Scheduled& scheduled : scheduled_) {
    const Schedule& schedule = scheduled.fault.schedule;
    if (schedule.of_replies() && scheduled.is_of(module) &&
        (schedule.when == When::Probably ? chance_.happens(schedule.probability)
                                         : ++scheduled.counted % schedule.count == 0)) {
      begin(scheduled, module);
    }
  }
  apply_at<FaultKind::OnReply>(module, reply, modules_[module]->module().state());
}

void Faults::written(std::size_t module) {
  for (Scheduled& scheduled : scheduled_) {
    const Schedule& schedule = scheduled.fault.schedule;
    if (schedule.when == When::AfterWrites && scheduled.is_of(module) &&
        ++scheduled.counted == schedule.count) {
      begin(scheduled, kEverywhere);
    }
  }
}

/// `place`: a module, or kEverywhere for the line.
template <class Effect, class... Affected>
void Faults::apply_at(std::size_t place, Affected&&... affected) const {
  for (const Scheduled& scheduled : scheduled_) {
    const Effect* const effect = std::get_if<Effect>(&scheduled.fault.kind->effect);
    if (effect != nullptr && scheduled.is_active_at(place)) {
      (*effect)(scheduled.fault, affected...);
    }
  }
}

void Faults::take_effect() {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    ModuleFaults faults;
    apply_at<FaultKind::OnModule>(i, faults);
    modules_[i]->interrupt_supply(faults.no_supply);
    modules_[i]->force_rate(faults.rate);
    modules_[i]->start_bad_images(faults.bad_images);
    modules_[i]->release_driver_late(faults.driver_late_by);
    if (faults.hangs) {
      modules_[i]->hang();
    }
  }
  LineFaults line;
  apply_at<FaultKind::OnLine>(kEverywhere, line);
  noise_.set_rates(line.noise);
  if (line.echo_after) {
    echo_.switch_on(*line.echo_after);
  } else {
    echo_.switch_off();
  }
  if (!line.foreign_bytes.empty() && stranger_.waiting() < kMostForeign) {
    stranger_.send(line.foreign_bytes.data(), line.foreign_bytes.size());
  }
  for (Scheduled& scheduled : scheduled_) {
    if (scheduled.fault.kind->lasts == FaultKind::Lasts::Moment) {
      scheduled.active.clear();
    }
  }
}

}  // namespace ex9000::sim
