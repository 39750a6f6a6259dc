#include "sim/virtual_line/bus_faults/echo.hpp"

namespace ex9000::sim {

void Echo::set_mode(SerialMode mode) {
  mode_ = mode;
  if (on_) {
    wire_.listen(mode_);
  }
}

void Echo::wake_at(VirtualTime when) {
  next_ = when;
  wire_.run_at(when);
}

void Echo::receive(std::uint8_t byte, ByteStatus /*status*/) {
  if (sent_ == 0) {
    if (heard_.size() < kMostHeard) {
      heard_.push_back(byte);
    }
    wake_at(bus_.clock().virtual_now() + delay_);
  }
}

void Echo::run() {
  if (sent_ == 0 && bus_.carries()) {
    // The echo waits for the byte that is on the wires, because `receive` is called only after the first stop
    // bit.
    wake_at(bus_.clock().virtual_now() + wire_.takes(1, mode_));
    return;
  }
  if (sent_ == 0) {
    began_ = bus_.clock().virtual_now();
    sends_in_ = mode_;
    wire_.drive(true);
  }
  if (sent_ == heard_.size()) {
    heard_.clear();
    sent_ = 0;
    wake_at(kNever);
    wire_.drive(false);
    return;
  }
  wire_.put(heard_[sent_], sends_in_);
  // The end of each byte is calculated from the start of the first byte, so that rounding errors do not
  // accumulate.
  wake_at(began_ + wire_.takes(++sent_, sends_in_));
}

}  // namespace ex9000::sim
