#include "sim/virtual_line/line/frame_spacing.hpp"

#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

FrameSpacing::FrameSpacing(Line& line) : line_(line) { line.wires().observe(*this); }

VirtualTime FrameSpacing::after_own() const { return last_byte_ + line_.rtu_silence(); }

VirtualTime FrameSpacing::after_others(std::uint8_t address) const {
  if (last_speaker_ <= line_.size()) {  // otherwise a fault has added the station
    const SimulatedModule& speaker = line_.module(last_speaker_ - 1);
    if (speaker.powered()) {
      const InForce& in_force = speaker.module().state().in_force;
      if (in_force.protocol == Protocol::ModbusRtu) {
        return in_force.address == address ? VirtualTime(0) : last_byte_ + line_.rtu_silence();
      }
    }
  }
  return is_for_modbus(address) ? last_byte_ + line_.rtu_separate() : VirtualTime(0);
}

bool FrameSpacing::is_for_modbus(std::uint8_t address) const {
  for (std::size_t i = 0; i < line_.size(); ++i) {
    const SimulatedModule& module = line_.module(i);
    if (module.powered()) {
      const InForce& in_force = module.module().state().in_force;
      if (in_force.protocol == Protocol::ModbusRtu && (address == 0 || address == in_force.address)) {
        return true;
      }
    }
  }
  return false;
}

void FrameSpacing::byte(std::size_t station, std::uint8_t /*byte*/, SerialMode /*mode*/, bool /*collided*/,
                        VirtualTime /*start*/, VirtualTime end) {
  last_speaker_ = station;
  last_byte_ = end;
}

}  // namespace ex9000::sim
