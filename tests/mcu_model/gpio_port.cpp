#include "tests/mcu_model/gpio_port.hpp"

namespace ex9000::registers {

namespace {

std::uint32_t debug_pins(char letter) { return letter == 'C' ? 0x0FU : 0; }

/// Returns the pins that GPIOCR protects (data sheets, "commit control").
std::uint32_t locked_pins(const Chip& chip, char letter) {
  if (!chip.port_control) {
    return debug_pins(letter) | (letter == 'B' ? 0x80U : 0);
  }
  return debug_pins(letter) | (letter == 'D' ? 0x80U : 0) | (letter == 'F' ? 0x01U : 0);
}

}  // namespace

std::uint32_t GpioPort::base_of(char letter) {
  const auto index = static_cast<std::uint32_t>(letter - 'A');
  return index < 4 ? 0x4000'4000U + index * 0x1000U : 0x4002'4000U + (index - 4) * 0x1000U;
}

GpioPort::GpioPort(const Chip& chip, char letter, PortNets& nets)
    : Peripheral(base_of(letter)),
      chip_(chip),
      nets_(nets),
      locked_(locked_pins(chip, letter)),
      function_(debug_pins(letter)),
      pull_up_(debug_pins(letter)),
      enable_(debug_pins(letter)) {
  if (chip.port_control && letter == 'C') {
    control_ = 0x1111;
  }
  drive_pins(kAll);
}

GpioPort::~GpioPort() {
  for (Net& net : nets_) {
    net.drive(End::Microcontroller, Drive::Nothing);
    net.drive(End::WeakPull, Drive::Nothing);
  }
}

std::uint32_t& GpioPort::stored(std::uint32_t offset) {
  switch (offset) {
    case kDirection:
      return direction_;
    case kSense:
      return sense_;
    case kBothEdges:
      return both_edges_;
    case kMask:
      return mask_;
    case kAlternate:
      return function_;
    case kDrive2:
      return drive_2_;
    case kDrive4:
      return drive_4_;
    case kDrive8:
      return drive_8_;
    case kOpenDrain:
      return open_drain_;
    case kPullUp:
      return pull_up_;
    case kPullDown:
      return pull_down_;
    case kEnable:
      return enable_;
    case kAnalog:
    case kControl:
      if (!chip_.port_control) {
        fault(offset, "this family has no such register");
      }
      return offset == kAnalog ? analog_ : control_;
    default:
      fault(offset, "the model has no such register of a port");
  }
}

std::uint32_t GpioPort::read(std::uint32_t offset) {
  if (offset < kDirection) {
    const std::uint32_t outputs = direction_ & ~function_;
    return ((data_ & outputs) | (input_ & ~outputs)) & (offset >> 2U);
  }
  if (offset == kMasked) {
    return raw_ & mask_;
  }
  return stored(offset);
}

void GpioPort::check_lock(std::uint32_t offset, std::uint32_t changed) const {
  const bool guarded = offset == kAlternate || offset == kPullUp || offset == kPullDown || offset == kEnable;
  if (guarded && (changed & locked_) != 0) {
    fault(offset, "the pin is locked; use another pin, because the model has no GPIOCR");
  }
}

void GpioPort::write(std::uint32_t offset, std::uint32_t value) {
  if (offset < kDirection) {
    const std::uint32_t pins = offset >> 2U;
    const std::uint32_t before = data_;
    data_ = (data_ & ~pins) | (value & pins);
    drive_pins(data_ ^ before);
    return;
  }
  if (offset == kClear) {
    raw_ &= ~value;
    tell_interrupt();
    return;
  }
  if (offset == kRaw || offset == kMasked) {
    fault(offset, "the register is read-only");
  }
  std::uint32_t& place = stored(offset);
  check_lock(offset, place ^ value);
  place = value;
  // A bit that is set in one drive strength register is cleared in the other two. The pull-up register and
  // the pull-down register clear each other's bits in the same way.
  for (const std::uint32_t other : {kDrive2, kDrive4, kDrive8}) {
    if (other != offset && (offset == kDrive2 || offset == kDrive4 || offset == kDrive8)) {
      stored(other) &= ~value;
    }
  }
  if (offset == kPullUp) {
    pull_down_ &= ~value;
  } else if (offset == kPullDown) {
    pull_up_ &= ~value;
  }
  drive_pins(kAll);
  tell_interrupt();
}

bool GpioPort::given_to(unsigned pin, std::uint32_t function) const {
  const bool chosen = !chip_.port_control || (control_ >> (4 * pin) & 0xFU) == function;
  return chosen && (function_ >> pin & 1U) != 0 && (enable_ >> pin & 1U) != 0;
}

void GpioPort::drive_pins(std::uint32_t pins) {
  for (unsigned pin = 0; pins >> pin != 0; ++pin) {
    if ((pins >> pin & 1U) != 0) {
      drive_pin(pin);
    }
  }
}

void GpioPort::drive_pin(unsigned pin) {
  const auto has = [pin](std::uint32_t bits) { return (bits >> pin & 1U) != 0; };
  Drive drive = Drive::Nothing;
  Drive pull = Drive::Nothing;
  if (has(enable_)) {
    if (has(function_)) {
      drive = alternate_drive_.at(pin);
    } else if (has(direction_)) {
      drive = has(data_) ? Drive::High : Drive::Low;
    }
    if (has(open_drain_) && drive == Drive::High) {
      drive = Drive::Nothing;
    }
    pull = has(pull_up_) ? Drive::WeakHigh : has(pull_down_) ? Drive::WeakLow : Drive::Nothing;
  }
  Net& net = nets_.at(pin);
  net.drive(End::Microcontroller, drive);
  net.drive(End::WeakPull, pull);
  look_at(pin);
}

void GpioPort::look_at(unsigned pin) {
  const std::uint32_t bit = 1U << pin;
  const bool level = (enable_ & bit) != 0 && nets_.at(pin).level();
  if (level == ((input_ & bit) != 0)) {
    return;
  }
  input_ ^= bit;
  if ((sense_ & bit) == 0 && ((both_edges_ & bit) != 0 || !level)) {
    raw_ |= bit;
    tell_interrupt();
  }
}

}  // namespace ex9000::registers
