#include "hal/doubles/serial_line.hpp"

#include <algorithm>

namespace ex9000::hal::doubles {

void SerialLine::send(Bytes bytes) {
  bytes_ = wire_.replaced(bytes);
  sent_ = 0;
  driving_ = true;
  wire_.drive(true);
  first_start_bit_ = next_ = clock_.virtual_now() + kDriverLead;
}

void SerialLine::run() {
  if (next_ > clock_.virtual_now()) {
    return;
  }
  if (sent_ == bytes_.size) {
    driving_ = false;
    next_ = over_ = kNever;
    wire_.drive(false);
    return;
  }
  wire_.put(bytes_[sent_++], mode_);
  // The time is calculated from the first start bit, so that rounding errors do not add up.
  next_ = first_start_bit_ + wire_.takes(sent_, mode_);
  if (sent_ == bytes_.size) {
    over_ = next_ + kDriverTail;
    next_ = over_ + late_by_;
  }
}

void SerialLine::release_late(VirtualTime by) {
  late_by_ = by;
  if (over_ != kNever) {
    next_ = std::max(over_ + by, clock_.virtual_now());
  }
}

void SerialLine::abort() {
  if (driving_) {
    driving_ = false;
    wire_.drive(false);
  }
  mode_ = {};
  next_ = over_ = kNever;
}

}  // namespace ex9000::hal::doubles
