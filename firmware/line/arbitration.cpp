#include "firmware/line/arbitration.hpp"

#include "firmware/line/crc16.hpp"
#include "firmware/line/rtu_frames.hpp"

namespace ex9000 {

namespace {

constexpr std::uint32_t kUnscanned = 0x6;
constexpr std::uint32_t kScanned = 0xF;
constexpr unsigned kPriorityAt = 28;

}  // namespace

void Arbitration::begin(Round round, const Contender& who, Time reported) {
  who_ = who;
  scanned_ = scanned_ && round == Round::Next;
  constexpr std::uint32_t kNumber = (1U << kPriorityAt) - 1U;
  word_ = (scanned_ ? kScanned : kUnscanned) << kPriorityAt | (who.serial_number & kNumber);
  begin_ = reported + timing_.arbitration;
  window_ = who.serial_number != 0 ? 0 : kOver;
}

Duration Arbitration::on_time(Time now, bool line_low, bool at_rest) {
  const Deadline due(begin_ + timing_.windows(window_));
  if (!due.reached(now)) {
    return due.remaining(now);
  }
  const Deadline next(begin_ + timing_.windows(window_ + 1));
  // A burst or an interrupt that takes a whole window would spoil the next one.
  if (!at_rest || sending_.load() || next.reached(now)) {
    window_ = kOver;
    return {};
  }
  ++window_;
  if (window_ > kWindows) {
    send(write_reply(), now);
    return {};
  }
  if (!bit_before(window_) && !line_low) {
    send({&modbus::kZeroInWindow, 1}, now);
  }
  return next.remaining(now);
}

Bytes Arbitration::write_reply() {
  std::size_t size = 0;
  const auto put = [&](std::uint8_t byte) { reply_[size++] = byte; };
  put(modbus::kScanAddress);
  put(modbus::kScanFunction);
  put(scanned_ ? modbus::kNobodyLeft : modbus::kFound);
  if (!scanned_) {
    for (unsigned bits = 32; bits != 0; bits -= 8) {
      put(static_cast<std::uint8_t>(who_.serial_number >> (bits - 8)));
    }
    put(who_.address);
  }
  scanned_ = true;
  const Crc16 crc = crc16({reply_.data(), size});
  put(crc.low_byte());
  put(crc.high_byte());
  return {reply_.data(), size};
}

void Arbitration::send(Bytes burst, Time now) {
  burst_ = burst;
  sent_since_.store_in_interrupt(now.microseconds());
  sending_.store_in_interrupt(true);
}

Bytes Arbitration::take_burst() {
  const Bytes burst = burst_;
  burst_ = {};
  return burst;
}

bool Arbitration::jams(Time now) const {
  const Duration longest(kLongestReply * timing_.character.microseconds());
  return sending_.load() && Deadline(Time(sent_since_.load()) + (longest + kReplyMargin)).reached(now);
}

bool Arbitration::hears_byte() {
  const bool own_zero = window_ != 0 && !bit_before(window_);
  if (!own_zero) {
    window_ = kOver;
  }
  return own_zero;
}

}  // namespace ex9000
