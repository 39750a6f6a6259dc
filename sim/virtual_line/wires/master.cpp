#include "sim/virtual_line/wires/master.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

Master::Master(Wires& wires, SerialMode mode, Receive receive)
    : clock_(wires.clock()), wire_(wires.attach(*this)), mode_(mode), receive_(std::move(receive)) {
  wire_.listen(mode_);
}

void Master::send(const std::uint8_t* bytes, std::size_t size, VirtualTime not_before,
                  const std::vector<std::size_t>& damaged, const void* sender) {
  const std::size_t first = waiting_.size();
  taken_ += size;
  for (std::size_t i = 0; i < size; ++i) {
    waiting_.push_back({bytes[i], false, sender});
  }
  for (const std::size_t position : damaged) {
    waiting_[first + position].damaged = true;
  }
  if (!sending() && !waiting_.empty()) {
    wake_at(std::max(clock_.virtual_now(), not_before));
    if (next_ == clock_.virtual_now()) {
      run();
    }
  }
}

void Master::drop(const void* sender) {
  waiting_.erase(std::remove_if(waiting_.begin(), waiting_.end(),
                                [sender](const Waiting& each) { return each.sender == sender; }),
                 waiting_.end());
}

void Master::set_mode(SerialMode mode) {
  if (mode != mode_) {
    mode_ = mode;
    burst_began_ = next_;
    burst_bytes_ = 0;
    wire_.listen(mode_);
    if (changed_) {
      changed_(mode_);
    }
  }
}

void Master::wake_at(VirtualTime when) {
  next_ = when;
  wire_.run_at(when);
}

void Master::run() {
  if (waiting_.empty()) {
    driving_ = false;
    wake_at(kNever);
    wire_.drive(false);
    return;
  }
  if (!driving_) {
    driving_ = true;
    wire_.drive(true);
    burst_began_ = clock_.virtual_now();
    burst_bytes_ = 0;
  }
  const Waiting next = waiting_.front();
  waiting_.pop_front();
  if (next.damaged) {
    wire_.put_with_wrong_parity(next.byte, mode_);
  } else {
    wire_.put(next.byte, mode_);
  }
  // The end of each byte is calculated from `burst_began_`, not from the end of the previous byte, so that
  // rounding errors do not accumulate.
  wake_at(burst_began_ + wire_.takes(++burst_bytes_, mode_));
}

void Master::receive(std::uint8_t byte, ByteStatus status) {
  if (!driving_) {
    if (also_receive_) {
      also_receive_(byte, status);
    }
    receive_(byte, status);
  }
}

}  // namespace ex9000::sim
