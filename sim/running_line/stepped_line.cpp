#include "sim/running_line/stepped_line.hpp"

#include <utility>

namespace ex9000::sim {

SteppedLine::SteppedLine(Line& line, const LinePorts::All& ports, FrameWatch* frames,
                         LinePorts::Notice notice)
    : line_(line), ports_(line, ports, std::move(notice)), frames_(frames) {}

void SteppedLine::start(Arrived arrived) {
  arrived_ = std::move(arrived);
  ports_.report_mismatches();
  for (const auto& port : ports_.all()) {
    // Only serial ports report wrong parity, and they cannot be combined with stepped time.
    port->start(
        [this, &port = *port](const std::uint8_t* bytes, std::size_t size,
                              const Port::Positions& /*damaged*/) { return receive(port, bytes, size); });
  }
}

bool SteppedLine::receive(const Port& port, const std::uint8_t* bytes, std::size_t size) {
  chunks_.push_back({&port, {bytes, bytes + size}});
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
  for (const Chunk& chunk : std::exchange(chunks_, {})) {
    ports_.take_rate(*chunk.port);
    line_.master().send(chunk.bytes.data(), chunk.bytes.size());
  }
  const bool paused = full();
  waiting_ = 0;
  if (paused) {
    for (const auto& port : ports_.all()) {
      port->resume();
    }
  }
}

void SteppedLine::run_until(VirtualTime until) {
  line_.bus().run_until(until);
  if (ports_.reply_is_complete()) {
    ports_.hand_out();  // the whole reply at once, not byte by byte
  }
  if (frames_ != nullptr) {
    frames_->run(until);
  }
}

}  // namespace ex9000::sim
