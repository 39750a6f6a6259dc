#include "sim/app/running_line/stepped_line.hpp"

#include <utility>

namespace ex9000::sim {

void SteppedLine::start(Arrived arrived) {
  arrived_ = std::move(arrived);
  ports_.report_mismatches();
  for (const auto& port : ports_.all()) {
    port->start(*this);
  }
}

/// Only serial ports report damaged bytes, and stepped time cannot use them.
bool SteppedLine::bytes(const Port& port, Bytes bytes, const Port::Positions& /*damaged*/,
                        Port::Sender /*sender*/) {
  return store(bytes.size, [this, &port, copy = std::vector<std::uint8_t>(bytes.begin(), bytes.end())] {
    ports_.take_rate(port);
    line_.master().send(copy.data(), copy.size());
  });
}

bool SteppedLine::store(std::size_t size, Put put) {
  arrivals_.push_back(std::move(put));
  waiting_ += size;
  arrived_();
  return !full();
}

void SteppedLine::read_ports() {
  for (const auto& port : ports_.all()) {
    port->read_waiting();
  }
}

void SteppedLine::put_on_line() {
  for (const Put& put : std::exchange(arrivals_, {})) {
    put();
  }
  const bool paused = full();
  waiting_ = 0;
  if (paused) {
    ports_.resume();
  }
}

void SteppedLine::run_until(VirtualTime until) {
  line_.wires().run_until(until);
  if (ports_.reply_is_complete()) {
    ports_.hand_out();
  }
  if (frames_ != nullptr) {
    frames_->run(until);
  }
}

}  // namespace ex9000::sim
