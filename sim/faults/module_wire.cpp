#include "sim/faults/module_wire.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

void ModuleWire::watch(Begins begins, Ends ends) {
  begins_ = std::move(begins);
  ends_ = std::move(ends);
}

void ModuleWire::drive(bool on) {
  if (on) {
    fate_ = begins_ ? begins_() : ReplyFate();
    if (!late_.empty()) {  // one reply after the other: behind one that is late, the next is late too
      fate_.late_by = std::max(fate_.late_by, late_.back().when - clock_.virtual_now());
    }
  }
  hand_on(on ? What::On : What::Off, 0, 0);
  if (!on && ends_) {
    ends_();
  }
}

void ModuleWire::put(std::uint8_t byte, std::uint32_t baud) { hand_on(What::Byte, byte, rate(baud)); }

void ModuleWire::hand_on(What what, std::uint8_t byte, std::uint32_t baud) {
  if (fate_.lost) {
    return;
  }
  if (fate_.late_by == VirtualTime(0) && late_.empty()) {
    carry_out(what, byte, baud);
  } else {
    late_.push_back({clock_.virtual_now() + fate_.late_by, what, byte, baud});
  }
}

void ModuleWire::carry_out(What what, std::uint8_t byte, std::uint32_t baud) {
  if (what == What::Byte) {
    wire_.put(byte, baud);
  } else {
    wire_.drive(what == What::On);
  }
}

void ModuleWire::run() {
  while (!late_.empty() && late_.front().when <= clock_.virtual_now()) {
    const Late due = late_.front();
    late_.pop_front();
    driving_late_ = due.what != What::Off;
    carry_out(due.what, due.byte, due.baud);
  }
}

void ModuleWire::abort() {
  late_.clear();
  if (std::exchange(driving_late_, false)) {
    wire_.drive(false);
  }
}

}  // namespace ex9000::sim
