#include "tests/mcu_model/uart_port.hpp"

#include "tests/support/line_control.hpp"

namespace ex9000::registers {

namespace {

constexpr std::uint32_t kReceivedBit = 1U << 4U;
constexpr std::uint32_t kTransmittedBit = 1U << 5U;
constexpr std::uint32_t kOverrunBit = 1U << 10U;
constexpr std::uint32_t kFifosOn = 1U << 4U;

}  // namespace

UartPort::UartPort(unsigned number, const SystemControl& clock, Timeline& timeline, Pins pins)
    : Peripheral(0x4000'C000U + number * 0x1000U),
      clock_(clock),
      timeline_(timeline),
      pins_(pins),
      sender_(
          timeline,
          [this](bool high) { pins_.port->alternate(pins_.transmit, high ? Drive::High : Drive::Low); },
          [this] { character_is_over(); }),
      receiver_(timeline, [this](SerialReceiver::Received received) { receive(received); }) {
  pins_.port->alternate(pins_.transmit, Drive::High);
}

std::uint32_t UartPort::read(std::uint32_t offset) {
  switch (offset) {
    case kData: {
      if (!receive_holding_) {
        fault(offset, "the data register is read while it contains no received byte");
      }
      const std::uint32_t value = *receive_holding_;
      receive_holding_.reset();
      raw_ &= ~kReceivedBit;
      tell_interrupt();
      return value;
    }
    case kFlags:
      return (shifting_ || transmit_holding_ ? 1U << 3U : 0) | (receive_holding_ ? 1U << 6U : 1U << 4U) |
             (transmit_holding_ ? 1U << 5U : 1U << 7U);
    case kMasked:
      return raw_ & mask_;
    default:
      fault(offset, "the model has no such register of a UART");
  }
}

void UartPort::write(std::uint32_t offset, std::uint32_t value) {
  const bool line = offset == kIntegerDivisor || offset == kFractionalDivisor || offset == kLineControl;
  if (line && (enabled() || shifting_)) {
    fault(offset, "the line is set up while the UART is enabled");
  }
  switch (offset) {
    case kData:
      transmit(static_cast<std::uint8_t>(value));
      break;
    case kIntegerDivisor:
      integer_divisor_ = value;
      divisors_latched_ = false;
      break;
    case kFractionalDivisor:
      fractional_divisor_ = value;
      divisors_latched_ = false;
      break;
    case kLineControl:
      if ((value & kFifosOn) != 0 || !line_format_of(value)) {
        fault(offset, "the simulation supports only 8N1, 8N2, 8E1 and 8O1, with the FIFOs off");
      }
      line_control_ = value;
      format_ = *line_format_of(value);
      receiver_.set_format(format_);
      divisors_latched_ = true;
      bit_time_ = (64 * integer_divisor_ + fractional_divisor_) * clock_.cycle() / 4;
      receiver_.set_bit_time(bit_time_);
      break;
    case kControl:
      if (shifting_) {
        fault(offset, "the control register is written while a character is being sent");
      }
      if ((value & 1U) != 0 && !divisors_latched_) {
        fault(offset, "divisors have no effect until the line control register is written");
      }
      if ((value & 1U) != 0 && (integer_divisor_ == 0 || line_control_ == 0)) {
        fault(offset, "the UART is enabled before it is set up");
      }
      control_ = value;
      break;
    case kMask:
      mask_ = value;
      tell_interrupt();
      break;
    case kClear:
      raw_ &= ~value;
      tell_interrupt();
      break;
    default:
      fault(offset, "the model has no writable register of a UART here");
  }
}

void UartPort::transmit(std::uint8_t byte) {
  if ((control_ & 0x101U) != 0x101U) {
    fault(kData, "the transmitter is off");
  }
  if (!pins_.port->given_to(pins_.transmit, pins_.function)) {
    fault(kData, "the transmit pin is not assigned to the UART");
  }
  if (transmit_holding_) {
    fault(kData, "the previous byte is still in the holding register");
  }
  if (shifting_) {
    transmit_holding_ = byte;
    raw_ &= ~kTransmittedBit;
    tell_interrupt();
  } else {
    begin_character(byte, timeline_.now());
  }
}

/// Begins to send a byte. The start bit begins at the first tick of the baud rate generator at or after
/// `not_before`. The generator runs continuously.
void UartPort::begin_character(std::uint8_t byte, Instant not_before) {
  const Instant tick = bit_time_ / 16;
  shifting_ = true;
  sender_.begin({byte}, format_, bit_time_, (not_before + tick - Instant(1)) / tick * tick);
  raise(kTransmittedBit);  // the holding register is empty
}

void UartPort::character_is_over() {
  shifting_ = false;
  if (transmit_holding_) {
    const std::uint8_t byte = *transmit_holding_;
    transmit_holding_.reset();
    shifting_ = true;
    sender_.begin({byte}, format_, bit_time_, timeline_.now());
    raise(kTransmittedBit);
  }
}

void UartPort::receive_level(bool high) {
  if ((control_ & 0x201U) == 0x201U && pins_.port->given_to(pins_.receive, pins_.function)) {
    receiver_.level(high);
  } else {
    receiver_.level(true);
  }
}

void UartPort::receive(SerialReceiver::Received received) {
  if (receive_holding_) {
    overrun_ = true;
    ++overruns_;
    raise(kOverrunBit);
    return;
  }
  // The overrun bit reports bytes that were lost before this byte.
  receive_holding_ = received.byte | (received.framing_error ? 1U << 8U : 0) |
                     (received.parity_error ? 1U << 9U : 0) | (received.was_break ? 1U << 10U : 0) |
                     (overrun_ ? 1U << 11U : 0);
  overrun_ = false;
  raise(kReceivedBit);
}

}  // namespace ex9000::registers
