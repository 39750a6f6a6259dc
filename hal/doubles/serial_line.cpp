#include "hal/doubles/serial_line.hpp"

#include <algorithm>

#include "firmware/expect.hpp"

namespace ex9000::hal::doubles {

void SerialLine::send(Bytes bytes) {
  EX9000_EXPECT(!sending());
  bytes_ = wire_.replaced(bytes);
  driving_ = true;
  wire_.drive(true);
  next_ = clock_.virtual_now() + kDriverLead;
}

void SerialLine::run() {
  if (next_ > clock_.virtual_now()) {
    return;
  }
  if (over_ == kNever) {
    over_ = next_ + wire_.takes(bytes_.size, mode_) + kDriverTail;
    next_ = over_ + late_by_;
    wire_.put(bytes_, mode_);
  } else {
    driving_ = false;
    next_ = over_ = kNever;
    wire_.drive(false);
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
