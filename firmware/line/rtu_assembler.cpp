#include "firmware/line/rtu_assembler.hpp"

#include "firmware/line/rtu_frames.hpp"

namespace ex9000 {

namespace {

constexpr unsigned kShortestFrame = 4;
constexpr unsigned kCrcBytes = 2;

}  // namespace

Verdict RtuAssembler::silence(FrameQueue& queue) {
  Verdict verdict = Verdict::Open;
  switch (state_) {  // not covered: the enumeration has no other value
    case State::Idle:
      break;
    case State::Receiving:
      verdict = conclude(queue);
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
  return state_ == State::GracePeriod ? timing_.rtu_grace : Duration();
}

Verdict RtuAssembler::cut_off(FrameQueue& queue) {
  const Verdict verdict = state_ == State::Idle ? Verdict::Open : conclude(queue);
  state_ = State::Idle;
  return verdict;
}

/// Judges the frame. If the CRC of the whole frame is wrong or the first byte is spoiled, ignores a leading
/// turn-around byte 00. Returns Open if the CRC or the length of the bytes that are not ignored is wrong, or
/// if one of these bytes is spoiled. Queues a frame that is a broadcast or has the address of this module,
/// except a host OK. Returns NoRoom if it cannot queue such a frame because another frame is already waiting.
Verdict RtuAssembler::conclude(FrameQueue& queue) {
  Frame& frame = queue.assembling();
  unsigned offset = 0;
  if (whole_.value() != 0 || first_spoiled_ || rest_spoiled_) {
    if (frame.storage[0] != kTurnAround || crc_after_first_.value() != 0 || rest_spoiled_) {
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
  frame.received = last_;
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
