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
  const bool follows = sending();
  const std::size_t first = waiting_.size();
  taken_ += size;
  for (std::size_t i = 0; i < size; ++i) {
    waiting_.push_back({bytes[i], false, sender});
  }
  for (const std::size_t position : damaged) {
    waiting_[first + position].damaged = true;
  }
  if (follows) {
    return;
  }
  if (not_before <= clock_.virtual_now()) {
    run();
  } else {
    wire_.run_at(not_before);
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
    wire_.listen(mode_);
    if (changed_) {
      changed_(mode_);
    }
  }
}

void Master::run() {
  if (!waiting_.empty()) {
    driving_ = true;
    wire_.drive(true);
    wire_.send();
  }
}

std::optional<Character> Master::next_byte() {
  if (waiting_.empty()) {
    driving_ = false;
    wire_.drive(false);
    return std::nullopt;
  }
  const Waiting next = waiting_.front();
  waiting_.pop_front();
  return Character{next.byte, mode_, next.damaged};
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
