#include "tests/qemu/signals.hpp"

#include <stdexcept>

namespace ex9000::rig {

namespace {

using hal::stellaris::PinGroup;
using hal::stellaris::Port;

template <class Groups>
Pin pin_of(const Groups& groups, unsigned channel) {
  unsigned first = 0;
  for (const PinGroup& group : groups) {
    if (channel < first + group.count) {
      return {group.port, static_cast<std::uint8_t>(group.first_pin + channel - first)};
    }
    first += group.count;
  }
  throw std::out_of_range("channel " + std::to_string(channel) +
                          ": the board has no such channel; expected a number less than " +
                          std::to_string(first));
}

/// Returns the path of the GPIO port in QEMU's object tree.
std::string path_of(Port port) {
  constexpr int kPortA = 8;
  return "/machine/unattached/device[" + std::to_string(kPortA + static_cast<int>(port)) + "]";
}

}  // namespace

Pin input_pin(unsigned channel) { return pin_of(board::kInputs, channel); }
Pin output_pin(unsigned channel) { return pin_of(board::kOutputs, channel); }

std::uint32_t port_address(Pin pin) {
  constexpr std::uint32_t kPortSize = 0x1000;
  const auto index = static_cast<std::uint32_t>(pin.port);
  return pin.port < Port::E ? 0x4000'4000 + index * kPortSize : 0x4002'4000 + (index - 4) * kPortSize;
}

std::uint32_t data_address(Pin pin) { return port_address(pin) + (pin.mask() << 2U); }

bool level_of(QtestClient& bus, Pin pin) { return bus.read(data_address(pin)) != 0; }

void set_pin_level(QtestClient& bus, Pin pin, bool level) {
  bus.set_input(path_of(pin.port), pin.number, level);
}

}  // namespace ex9000::rig
