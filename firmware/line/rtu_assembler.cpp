#include "firmware/line/rtu_assembler.hpp"

#include "firmware/modbus/host_ok.hpp"

namespace ex9000 {

namespace {

constexpr unsigned kShortestFrame = 4;
constexpr unsigned kCrcBytes = 2;
constexpr std::uint8_t kTurnAround = 0x00;
constexpr std::uint8_t kBroadcast = 0;

}  // namespace

Verdict RtuAssembler::byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, Time now) {
  Verdict before = Verdict::Open;
  const Duration gap = now.since(last_);
  last_ = now;
  if (state_ == State::GracePeriod && !(gap < timing_.rtu_silence + timing_.rtu_grace)) {
    before = loss_verdict();  // the byte began after T3.5, but the timer interrupt has not run yet
    state_ = State::Idle;
  }
  if (state_ == State::Idle) {
    open();
  } else if (timing_.rtu_slack < gap) {
    spoil();
  }
  state_ = State::Receiving;
  append(queue.assembling(), byte);
  if (status != ByteStatus::Good) {
    spoil();
    overrun_ = overrun_ || status == ByteStatus::Overrun;
  }
  return before;
}

void RtuAssembler::open() {
  received_ = 0;
  first_spoiled_ = false;
  rest_spoiled_ = false;
  overrun_ = false;
  whole_ = Crc16();
  crc_after_first_ = Crc16();
}

/// Marks the last byte, or the gap after it, as faulty.
void RtuAssembler::spoil() {
  if (received_ == 1) {
    first_spoiled_ = true;
  } else {
    rest_spoiled_ = true;
  }
}

void RtuAssembler::append(Frame& frame, std::uint8_t byte) {
  whole_.add(byte);
  if (received_ != 0 && frame.storage[0] == kTurnAround) {
    crc_after_first_.add(byte);
  }
  if (received_ < frame.storage.size()) {
    frame.storage[received_] = byte;
  }
  ++received_;
}

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

/// Queues the frame if its CRC is correct, either from the first byte or after a turn-around byte 00, and if
/// it is a broadcast or has the address of this module. Does not queue a host OK.
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
  if (address != own_address_.load() && address != kBroadcast) {
    return Verdict::Foreign;
  }
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
