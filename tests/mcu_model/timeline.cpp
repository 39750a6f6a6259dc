#include "tests/mcu_model/timeline.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::registers {

Instant Timeline::next() {
  if (!next_known_) {
    next_ = nullptr;
    next_at_ = kNever;
    for (Alarm* alarm : alarms_) {
      if (alarm->when_ < next_at_) {
        next_ = alarm;
        next_at_ = alarm->when_;
      }
    }
    next_known_ = true;
  }
  return next_at_;
}

void Timeline::advance(Instant to) {
  while (next() <= to && next_ != nullptr) {
    now_ = std::max(now_, next_at_);
    Alarm& rings = *next_;
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
