#include "sim/virtual_line/wires/module_wire.hpp"

#include <algorithm>
#include <utility>

#include "firmware/line/rtu_frames.hpp"

namespace ex9000::sim {

Bytes ModuleWire::replaced(Bytes bytes) {
  if (!begins_) {
    return bytes;
  }
  reply_ = Reply{{bytes.begin(), bytes.end()}};
  is_reply_ = bytes.size != 1 || bytes[0] != modbus::kZeroInWindow;
  if (is_reply_) {
    begins_(reply_);
  }
  return {reply_.bytes.data(), reply_.bytes.size()};
}

void ModuleWire::drive(bool on) {
  drives_ = on;
  if (on) {
    reply_.lost = reply_.lost || late_.size() > kMostLate;
    forced_for_reply_ = forced_;
    delay_ = reply_.late_by;
    if (!late_.empty()) {  // replies keep their order: a reply after a late one is late too
      delay_ = std::max(delay_, late_.back().when - clock_.virtual_now());
    }
  }
  hand_on(on ? What::On : What::Off, {}, {});
  if (!on && ends_ && is_reply_) {
    ends_();
  }
}

void ModuleWire::put(Bytes bytes, SerialMode mode) {
  hand_on(What::Reply, {bytes.begin(), bytes.end()}, reply_mode(mode));
}

void ModuleWire::hand_on(What what, std::vector<std::uint8_t> bytes, SerialMode mode) {
  if (reply_.lost) {
    return;
  }
  const VirtualTime now = clock_.virtual_now();
  Event event{now, now + delay_, what, std::move(bytes), mode, reply_.late_by, reply_.delayed_by};
  if (delay_ == VirtualTime(0) && late_.empty()) {
    carry_out(std::move(event));
    driving_late_ = driving_late_ && what != What::Off;  // `run` may have begun this reply as a late one
  } else {
    late_.push_back(std::move(event));
  }
}

void ModuleWire::carry_out(Event event) {
  switch (event.what) {
    case What::On:
      wire_.drive(true);
      break;
    case What::Reply:
      on_wires_ = std::move(event.bytes);
      sent_ = 0;
      mode_ = event.mode;
      wire_.send();
      break;
    case What::Off:
      wire_.drive(false);
      break;
  }
}

void ModuleWire::run() {
  while (!late_.empty() && late_.front().when <= clock_.virtual_now()) {
    Event due = std::move(late_.front());
    late_.pop_front();
    driving_late_ = due.what != What::Off;
    carry_out(std::move(due));
  }
}

std::optional<Character> ModuleWire::next_byte() {
  return sent_ < on_wires_.size() ? std::optional(Character{on_wires_[sent_++], mode_}) : std::nullopt;
}

void ModuleWire::end_delays(std::size_t fault) {
  VirtualTime free = clock_.virtual_now();  // the time from which the next reply can be on the wires
  std::optional<VirtualTime> delay;         // the delay of the previous reply that waits
  for (Event& late : late_) {
    if (late.what == What::On) {
      late.late_by = late.delayed_by == fault ? VirtualTime(0) : late.late_by;
      delay = std::max({late.late_by, free - late.sent, delay.value_or(VirtualTime(0))});
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
  late_.clear();
}

}  // namespace ex9000::sim
