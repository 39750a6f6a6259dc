#include "firmware/line/rtu_assembler.hpp"

#include "firmware/line/rtu_frames.hpp"

namespace ex9000 {

namespace {

constexpr unsigned kShortestFrame = 4;
constexpr unsigned kCrcBytes = 2;

}  // namespace

/// Opens a frame, or continues it after the silence timer has expired.
void RtuAssembler::go_on(FrameQueue& queue, std::uint8_t byte) {
  if (state_ == State::Idle) {
    open(queue, byte);
  } else {
    if (strict()) {
      spoil();
    }
    crc_after_zero_.add(byte);
  }
  state_ = State::Receiving;
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
}

Verdict RtuAssembler::silence(FrameQueue& queue, Time now) {
  Verdict verdict = Verdict::Open;
  switch (state_) {  // not covered: the enumeration has no other value
    case State::Idle:
      break;
    case State::Receiving:
      if (strict()) {
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
    return timing_.rtu_silence - timing_.rtu_slack;
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
  const unsigned size = received_ - offset;
  if (size < kShortestFrame || size > kLongestFrame) {
    return Verdict::Open;
  }
  const std::uint8_t address = frame.storage[offset];
  const bool is_exception = (frame.storage[offset + 1] & modbus::kExceptionFlag) != 0;
  if (is_exception || (address != own_address_.load() && address != modbus::kBroadcast)) {
    return Verdict::Foreign;
  }
  broadcast_ = address == modbus::kBroadcast;
  frame.offset = static_cast<std::uint16_t>(offset);
  frame.size = static_cast<std::uint16_t>(size - kCrcBytes);
  frame.received = received;
  if (modbus::is_host_ok(frame.bytes())) {
    return Verdict::HostOk;
  }
  return queue.complete_in_interrupt() ? Verdict::Accepted : Verdict::NoRoom;
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
