#include "sim/app/running_line/line_ports.hpp"
#include "sim/text/values.hpp"

#include <algorithm>

namespace ex9000::sim {

LinePorts::LinePorts(Line& line, const All& ports, Notice notice)
    : line_(line), ports_(ports), notice_(std::move(notice)), reported_(line.size()) {
  line.wires().observe(*this);
}

void LinePorts::driver(std::size_t station, bool on, VirtualTime /*now*/) {
  stopped_sending_ |= station != 0 && !on;
}

void LinePorts::hand_out() {
  const bool stopped = std::exchange(stopped_sending_, false);
  sent_ += heard_.size();
  for (const auto& port : ports_) {
    if (!heard_.empty()) {
      report_dropped(*port, port->send(heard_));
    }
    if (stopped) {
      port->sent();
    }
  }
  heard_.clear();
}

void LinePorts::report_dropped(const Port& port, std::size_t bytes) {
  const auto known = std::find(full_.begin(), full_.end(), &port);
  if (bytes == 0 && known != full_.end()) {
    full_.erase(known);
  } else if (bytes != 0 && known == full_.end()) {
    full_.push_back(&port);
    const std::string dropped =
        std::to_string(bytes) + (bytes == 1 ? " byte is dropped" : " bytes are dropped");
    notice_(port.is_a_line() ? "the serial port is full: " + dropped
                             : "a port is full: " + dropped +
                                   ", because a master does not read; later bytes for this master are "
                                   "dropped too until it reads");
  }
}

void LinePorts::take_rate(const Port& port) {
  if (const auto rate = port.baud()) {
    line_.master().set_baud(*rate);
  }
  report_mismatches();
}

void LinePorts::resume() {
  for (const auto& port : ports_) {
    port->resume();
  }
}

bool LinePorts::hold_line() const {
  return std::any_of(ports_.begin(), ports_.end(), [](const auto& port) { return port->holds_line(); });
}

void LinePorts::report_mismatches() {
  const SerialMode mode = line_.master().mode();
  if (!mismatches_ && line_.wires().all_hear(mode)) {
    return;
  }
  mismatches_ = false;
  for (std::size_t i = 0; i < line_.size(); ++i) {
    const SimulatedModule& module = line_.module(i);
    const bool listens = module.powered() && module.module().listening();
    const bool hears = !listens || hear_each_other(module.mode(), mode);
    const Mismatch mismatch = hears ? Mismatch{} : Mismatch{mode, module.mode()};
    if (mismatch != reported_[i] && mismatch != Mismatch{}) {
      notice_("the line is at " + mode_text(mode.baud, mode.format) + ", " +
              std::string(module.model().designation) + " at " +
              hex_byte_text(module.module().state().in_force.address) + " listens at " +
              mode_text(module.mode().baud, module.mode().format));
    }
    if (listens) {
      reported_[i] = mismatch;
    }
    mismatches_ = mismatches_ || reported_[i] != Mismatch{};
  }
}

}  // namespace ex9000::sim
