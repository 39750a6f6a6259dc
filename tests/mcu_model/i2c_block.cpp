#include "tests/mcu_model/i2c_block.hpp"

namespace ex9000::registers {

namespace {

constexpr std::uint32_t kRun = 1U << 0U;
constexpr std::uint32_t kStart = 1U << 1U;
constexpr std::uint32_t kStop = 1U << 2U;
constexpr std::uint32_t kAcknowledge = 1U << 3U;

constexpr std::uint32_t kBusy = 1U << 0U;
constexpr std::uint32_t kError = 1U << 1U;
constexpr std::uint32_t kAddressError = 1U << 2U;
constexpr std::uint32_t kDataError = 1U << 3U;
constexpr std::uint32_t kArbitrationLost = 1U << 4U;
constexpr std::uint32_t kIdle = 1U << 5U;
constexpr std::uint32_t kBusBusy = 1U << 6U;

constexpr std::uint32_t kMaster = 1U << 4U;

// The low time and the high time of the clock in each bit, in tenths of the bit time: SCL_LP and SCL_HP of
// the data sheets.
constexpr int kLowTime = 6;
constexpr int kHighTime = 4;

}  // namespace

I2cBlock::I2cBlock(const Chip& chip, const SystemControl& clock, Timeline& timeline, GpioPort& port_b,
                   PortNets& nets, I2cBehaviour behaviour)
    : Peripheral(kBase),
      chip_(chip),
      clock_(clock),
      port_(port_b),
      nets_(nets),
      behaviour_(behaviour),
      next_(timeline, [this] { go_on(); }) {
  software_reset();
}

void I2cBlock::software_reset() {
  target_ = data_ = mask_ = raw_ = configuration_ = status_ = 0;
  period_ = 1;
  busy_ = owns_bus_ = receiving_ = addressing_ = stop_asked_ = only_stopping_ = waits_for_clock_ = false;
  moves_.clear();
  next_.cancel();
  clock(true);
  data(true);
  tell_interrupt();
}

std::uint32_t I2cBlock::read(std::uint32_t offset) {
  switch (offset) {
    case kControl:
      if (busy_) {
        return kBusy | kError | kArbitrationLost;  // the other bits are not valid while BUSY is set
      }
      return status_ | (owns_bus_ ? kBusBusy : kIdle);
    case kData:
      return data_;
    default:
      fault(offset, "the model has no such register of an I2C master");
  }
}

void I2cBlock::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case kTarget:
      target_ = value;
      break;
    case kControl:
      command(value);
      break;
    case kData:
      data_ = value;
      break;
    case kPeriod:
      if (value > 0x7F) {
        fault(offset, "the timer period has more than 7 bits");
      }
      period_ = value;
      break;
    case kMask:
      mask_ = value;
      tell_interrupt();
      break;
    case kClear:
      raw_ &= ~value;
      tell_interrupt();
      break;
    case kConfiguration:
      configuration_ = value;
      break;
    default:
      fault(offset, "the model has no writable register of an I2C master here");
  }
}

void I2cBlock::check_pins() const {
  if (!port_.given_to(kClockPin, kFunction) || !port_.given_to(kDataPin, kFunction)) {
    fault(kControl, "the pins of the I2C master are not assigned to it");
  }
  const std::uint32_t open_drain = port_.peek(GpioPort::kOpenDrain);
  if ((open_drain >> kDataPin & 1U) == 0 ||
      ((open_drain >> kClockPin & 1U) != 0) != chip_.i2c_clock_open_drain) {
    fault(kControl, "the pins of the I2C master do not have the open-drain setting that the family requires");
  }
}

void I2cBlock::command(std::uint32_t bits) {
  if (busy_) {
    fault(kControl, "a command is written while another is in progress");
  }
  if ((configuration_ & kMaster) == 0) {
    fault(kControl, "the block is not in master mode");
  }
  const bool starts = (bits & (kRun | kStart)) == (kRun | kStart);
  const bool goes_on = (bits & kRun) != 0 && owns_bus_;
  const bool only_stops = (bits & (kRun | kStart | kStop)) == kStop && owns_bus_;
  if (!starts && !goes_on && !only_stops) {
    return;  // not a command in this state
  }
  check_pins();
  status_ = 0;
  busy_ = true;
  stop_asked_ = (bits & kStop) != 0;
  only_stopping_ = only_stops;
  addressing_ = starts;
  if (starts) {
    receiving_ = (target_ & 1U) != 0;
    moves_.push_back(Move::Start);
    queue_byte(static_cast<std::uint8_t>(target_));
    moves_.push_back(Move::TakeAcknowledge);
  }
  if ((bits & kRun) != 0) {
    if (receiving_) {
      for (int i = 0; i < 8; ++i) {
        moves_.push_back(Move::Take);
      }
      moves_.push_back((bits & kAcknowledge) != 0 ? Move::Zero : Move::One);
    } else {
      queue_byte(static_cast<std::uint8_t>(data_));
      moves_.push_back(Move::TakeAcknowledge);
    }
  }
  if (stop_asked_) {
    moves_.push_back(Move::Stop);
  }
  taken_ = 0;
  taken_bits_ = 0;
  begin_move();
}

void I2cBlock::queue_byte(std::uint8_t byte) {
  for (int bit = 7; bit >= 0; --bit) {
    moves_.push_back((byte >> bit & 1) != 0 ? Move::One : Move::Zero);
  }
}

void I2cBlock::clock(bool high) {
  port_.alternate(kClockPin, !high ? Drive::Low : chip_.i2c_clock_open_drain ? Drive::High : Drive::Nothing);
}
void I2cBlock::data(bool high) { port_.alternate(kDataPin, high ? Drive::High : Drive::Low); }

/// Begins the next move, for example a START or a bit; if there is none, finishes the command. Each move
/// begins and ends with the clock low, except that the bus is free before a START and after a STOP.
void I2cBlock::begin_move() {
  phase_ = 0;
  if (moves_.empty()) {
    finish();
    return;
  }
  const Move move = moves_.front();
  if (move == Move::Start) {
    if (!clock_high() || !data_high()) {
      if (behaviour_.waits_for_free_bus) {
        return;  // the block stays busy until it is reset
      }
      fail(kArbitrationLost);
      return;
    }
    owns_bus_ = true;
    data(false);
    next_.set_after(kHighTime * bit_time() / 10);
    return;
  }
  data(move == Move::Stop ? false : move != Move::Zero);
  next_.set_after(kLowTime * bit_time() / 10);
}

void I2cBlock::go_on() {
  const Move move = moves_.front();
  if (move == Move::Start) {
    clock(false);
    move_is_over();
    return;
  }
  switch (phase_++) {
    case 0:
      clock(true);
      if (clock_high()) {
        clock_is_high();
      } else {
        waits_for_clock_ = true;
      }
      break;
    case 1:
      end_bit();
      break;
    default:
      move_is_over();  // the required time after a STOP has passed
      break;
  }
}

void I2cBlock::look_at_clock() {
  if (waits_for_clock_ && clock_high()) {
    clock_is_high();
  }
}

void I2cBlock::clock_is_high() {
  waits_for_clock_ = false;
  next_.set_after(kHighTime * bit_time() / 10);
}

void I2cBlock::end_bit() {
  const Move move = moves_.front();
  const bool level = data_high();
  if (move == Move::Stop) {
    data(true);
    owns_bus_ = false;
    if (!data_high()) {
      fail(kArbitrationLost);
      return;
    }
    next_.set_after(kLowTime * bit_time() / 10);
    return;
  }
  if (move == Move::One && !level && (addressing_ || !receiving_)) {
    fail(kArbitrationLost);
    return;
  }
  clock(false);
  if (move == Move::Take) {
    taken_ = static_cast<std::uint8_t>(unsigned{taken_} << 1U | (level ? 1U : 0U));
    if (++taken_bits_ == 8) {
      data_ = taken_;
    }
  } else if (move == Move::TakeAcknowledge) {
    const std::uint32_t error = addressing_ ? kAddressError : kDataError;
    addressing_ = false;
    if (level) {
      fail(error);
      return;
    }
  }
  move_is_over();
}

void I2cBlock::move_is_over() {
  moves_.pop_front();
  begin_move();
}

void I2cBlock::fail(std::uint32_t bits) {
  const bool is_error = bits != kArbitrationLost || !behaviour_.loss_is_no_error;
  status_ = bits | (is_error ? kError : 0);
  moves_.clear();
  if ((bits & kArbitrationLost) != 0) {
    owns_bus_ = false;
    clock(true);
    data(true);
  } else if (stop_asked_ && behaviour_.stops_after_error) {
    moves_.push_back(Move::Stop);
    begin_move();
    return;
  }
  finish();
}

void I2cBlock::finish() {
  busy_ = false;
  if (!only_stopping_ || behaviour_.stop_interrupts) {
    raw_ |= 1U;
    tell_interrupt();
  }
}

}  // namespace ex9000::registers
