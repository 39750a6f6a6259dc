#include "sim/virtual_line/bus/module_wire.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

void ModuleWire::watch(Begins begins, Ends ends, OnTheWires on_the_wires) {
  begins_ = std::move(begins);
  ends_ = std::move(ends);
  on_the_wires_ = std::move(on_the_wires);
}

void ModuleWire::drive(bool on) {
  drives_ = on;
  if (on) {
    ++reply_;
    fate_ = begins_(reply_);
    fate_.lost = fate_.lost || late_.size() > kMostLate;
    if (fate_.lost) {
      on_the_wires_(reply_, false);
    }
    forced_for_reply_ = forced_;
    delay_ = fate_.late_by;
    if (!late_.empty()) {  // replies keep their order: a reply after a late one is late too
      delay_ = std::max(delay_, late_.back().when - clock_.virtual_now());
    }
  }
  hand_on(on ? What::On : What::Off, 0, {});
  if (!on) {
    ends_();
  }
}

void ModuleWire::put(std::uint8_t byte, SerialMode mode) { hand_on(What::Byte, byte, reply_mode(mode)); }

void ModuleWire::hand_on(What what, std::uint8_t byte, SerialMode mode) {
  if (fate_.lost) {
    return;
  }
  const VirtualTime now = clock_.virtual_now();
  const Event event{now, now + delay_, what, byte, mode, reply_, fate_};
  if (delay_ == VirtualTime(0) && late_.empty()) {
    carry_out(event);
    driving_late_ = driving_late_ && what != What::Off;  // `run` may have begun this reply as a late one
  } else {
    late_.push_back(event);
  }
}

void ModuleWire::carry_out(const Event& event) {
  switch (event.what) {
    case What::On:
      on_the_wires_(event.reply, true);
      wire_.drive(true);
      break;
    case What::Byte:
      wire_.put(event.byte, event.mode);
      break;
    case What::Off:
      wire_.drive(false);
      on_the_wires_(event.reply, false);
      break;
  }
}

void ModuleWire::run() {
  while (!late_.empty() && late_.front().when <= clock_.virtual_now()) {
    const Event due = late_.front();
    late_.pop_front();
    driving_late_ = due.what != What::Off;
    carry_out(due);
  }
}

void ModuleWire::end_delays(std::optional<std::size_t> fault) {
  VirtualTime free = clock_.virtual_now();  // the time from which the next reply can be on the wires
  std::optional<VirtualTime> delay;  // the delay of the previous reply; nullopt: no previous reply waits
  for (Event& late : late_) {
    if (late.what == What::On) {
      if (fault.value_or(late.fate.delayed_by) == late.fate.delayed_by) {
        // With the delay of the previous reply, the time between the two is the same as at the UART.
        late.fate.late_by = delay.value_or(VirtualTime(0));
      }
      delay = std::max(late.fate.late_by, free - late.sent);
    }
    if (delay) {
      late.when = late.sent + *delay;
    }
    free = std::max(free, late.when);
  }
  delay_ = delay.value_or(delay_);  // has an effect only if the UART still sends the last reply
}

void ModuleWire::abort() {
  if (std::exchange(driving_late_, false)) {
    wire_.drive(false);
  }
  for (const Event& never : std::exchange(late_, {})) {
    if (never.what == What::Off) {
      on_the_wires_(never.reply, false);
    }
  }
}

}  // namespace ex9000::sim
