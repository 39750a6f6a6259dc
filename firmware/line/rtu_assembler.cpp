#include "firmware/line/rtu_assembler.hpp"

#include <algorithm>

#include "firmware/line/rtu_frames.hpp"

namespace ex9000 {

namespace {

constexpr unsigned kShortestFrame = 4;
constexpr unsigned kCrcBytes = 2;

/// FD; a byte FF of an arbitration, in which the start bit of another module may stand; or a turn-around
/// byte.
constexpr bool may_precede_a_round(std::uint8_t first) {
  const unsigned zeros = ~unsigned{first} & 0xFFU;
  return first == 0 || (zeros & (zeros - 1U)) == 0;
}

}  // namespace

/// Opens a frame, or continues it after the silence timer has expired. False if the byte belongs to an
/// arbitration.
bool RtuAssembler::go_on(FrameQueue& queue, std::uint8_t byte) {
  if (arbitration_.active() && arbitration_.hears_byte()) {
    return false;
  }
  if (state_ == State::Idle) {
    open(queue, byte);
  } else {
    if (strict()) {
      spoil();
    }
    crc_after_zero_.add(byte);
  }
  state_ = State::Receiving;
  return true;
}

void RtuAssembler::open(FrameQueue& queue, std::uint8_t first) {
  frame_ = &queue.assembling();
  received_ = 0;
  after_zero_ = first == kTurnAround;
  first_spoiled_ = false;
  rest_spoiled_ = false;
  overrun_ = false;
  whole_ = Crc16();
  crc_after_zero_ = Crc16();
  may_ask_for_round_ = may_precede_a_round(first);
  first_wait_ = may_ask_for_round_ ? wait_if_round_ : usual_wait_;
}

void RtuAssembler::use(const LineTiming& timing) {
  timing_ = timing;
  arbitration_.use(timing);
  usual_wait_ = std::min(timing.rtu_slack, timing.rtu_silence);
  // Above 19200 baud, an arbitration begins before T3.5 is over.
  wait_if_round_ = std::min(usual_wait_, timing.arbitration);
}

/// Of the last bytes, whatever is before them: masters ask for the next round sooner than T3.5 after a reply,
/// which modules that have lost hear after the bytes FF of the arbitration. Line errors before them, and the
/// gap, do not matter.
Arbitration::Round RtuAssembler::round() const {
  constexpr std::uint32_t kSize = 5;
  const bool spoiled = received_ == kSize && (first_spoiled_ || rest_spoiled_);
  if (!may_ask_for_round_ || received_ < kSize || received_ > frame_->storage.size() || spoiled) {
    return Arbitration::Round::None;
  }
  const Bytes last{frame_->storage.data() + (received_ - kSize), kSize};
  if (last[0] != modbus::kScanAddress || last[1] != modbus::kScanFunction || crc16(last).value() != 0) {
    return Arbitration::Round::None;
  }
  return last[2] == modbus::kFirstRound  ? Arbitration::Round::First
         : last[2] == modbus::kNextRound ? Arbitration::Round::Next
                                         : Arbitration::Round::None;
}

/// False if the open frame asks for none.
bool RtuAssembler::begin_round(Time now) {
  const Arbitration::Round asked = round();
  if (asked != Arbitration::Round::None) {
    arbitration_.begin(asked, {serial_number_.load(), static_cast<std::uint8_t>(own_address_.load())},
                       now - first_wait_);
  }
  return asked != Arbitration::Round::None;
}

Verdict RtuAssembler::silence(FrameQueue& queue, Time now) {
  Verdict verdict = Verdict::Open;
  switch (state_) {  // not covered: the enumeration has no other value
    case State::Idle:
      break;
    case State::Receiving:
      if (may_ask_for_round_ && begin_round(now)) {
        verdict = conclude(queue, now);
        verdict = verdict == Verdict::Open ? loss_verdict() : verdict;
        state_ = State::Idle;
        break;
      }
      if (first_wait_ < timing_.rtu_silence) {
        state_ = State::LongGap;
        break;
      }
      [[fallthrough]];
    case State::LongGap:
      verdict = conclude(queue, now - timing_.rtu_silence);
      state_ = verdict == Verdict::Open ? State::GracePeriod : State::Idle;
      break;
    case State::GracePeriod:
      verdict = loss_verdict();
      state_ = State::Idle;
      break;
  }
  return verdict;
}

Duration RtuAssembler::next_wait() const {
  if (state_ == State::LongGap) {
    return timing_.rtu_silence - first_wait_;
  }
  return state_ == State::GracePeriod ? timing_.rtu_grace : Duration();
}

Verdict RtuAssembler::cut_off(FrameQueue& queue, Time now) {
  const Verdict verdict = state_ == State::Idle ? Verdict::Open : conclude(queue, now);
  state_ = State::Idle;
  return verdict;
}

/// If the CRC of the whole frame is wrong or its first byte is spoiled, ignores a leading turn-around byte
/// 00. Open if the rest has a wrong CRC, a wrong length or a spoiled byte. Queues a frame for this module or
/// for all, but no host OK; NoRoom if another waits. `received`: time of the last byte, or slightly later.
Verdict RtuAssembler::conclude(FrameQueue& queue, Time received) {
  Frame& frame = *frame_;
  unsigned offset = 0;
  if (whole_.value() != 0 || first_spoiled_ || rest_spoiled_) {
    if (!after_zero_ || crc_after_zero_.value() != 0 || rest_spoiled_) {
      return Verdict::Open;
    }
    offset = 1;
  }
  unsigned size = received_ - offset;
  if (size < kShortestFrame || size > kLongestFrame) {
    return Verdict::Open;
  }
  const bool by_number =
      frame.storage[offset] == modbus::kScanAddress && has_own_number(frame.storage.data() + offset, size);
  if (by_number) {
    offset += modbus::kNumberPrefix;
    size -= modbus::kNumberPrefix;
  }
  const std::uint8_t address = frame.storage[offset];
  const bool is_exception = (frame.storage[offset + 1] & modbus::kExceptionFlag) != 0;
  const bool is_broadcast = !by_number && address == modbus::kBroadcast;
  if (is_exception || (!by_number && !is_broadcast && address != own_address_.load())) {
    return Verdict::Foreign;
  }
  broadcast_ = is_broadcast;
  frame.by_serial_number = by_number;
  frame.offset = static_cast<std::uint16_t>(offset);
  frame.size = static_cast<std::uint16_t>(size - kCrcBytes);
  frame.received = received;
  if (modbus::is_host_ok(frame.bytes())) {
    return Verdict::HostOk;
  }
  return queue.complete_in_interrupt() ? Verdict::Accepted : Verdict::NoRoom;
}

/// `frame` of `size` bytes, at address FD, is a request by serial number, and the number is this module's.
bool RtuAssembler::has_own_number(const std::uint8_t* frame, unsigned size) const {
  const Bytes bytes{frame, size};
  const std::uint32_t number = serial_number_.load();
  return size >= modbus::kNumberPrefix + kShortestFrame && number != 0 && frame[1] == modbus::kScanFunction &&
         frame[2] == modbus::kRequestByNumber &&
         (std::uint32_t{bytes.word(modbus::kNumberAt)} << 16U | bytes.word(modbus::kNumberAt + 2)) == number;
}

Verdict RtuAssembler::loss_verdict() const {
  if (overrun_) {
    return Verdict::Overrun;
  }
  if (first_spoiled_ || rest_spoiled_) {
    return Verdict::LineError;
  }
  if (received_ < kShortestFrame) {
    return Verdict::TooShort;
  }
  return received_ > kLongestFrame ? Verdict::TooLong : Verdict::BadCheck;
}

}  // namespace ex9000
