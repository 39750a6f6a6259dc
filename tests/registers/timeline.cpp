#include "tests/registers/timeline.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::registers {

Instant Timeline::next() {
  if (!next_known_) {
    next_ = kNever;
    for (const Alarm* alarm : alarms_) {
      next_ = std::min(next_, alarm->when_);
    }
    next_known_ = true;
  }
  return next_;
}

void Timeline::advance(Instant to) {
  while (next() <= to) {
    const Instant due = next();
    now_ = std::max(now_, due);
    const auto alarm =
        std::find_if(alarms_.begin(), alarms_.end(), [due](const Alarm* each) { return each->when_ == due; });
    Alarm& rings = **alarm;
    rings.cancel();
    rings.ring_();
  }
  now_ = std::max(now_, to);
}

Alarm::Alarm(Timeline& timeline, std::function<void()> ring) : timeline_(timeline), ring_(std::move(ring)) {
  timeline_.alarms_.push_back(this);
}

Alarm::~Alarm() {
  auto& alarms = timeline_.alarms_;
  alarms.erase(std::find(alarms.begin(), alarms.end(), this));
  timeline_.next_known_ = false;
}

}  // namespace ex9000::registers
