#include "firmware/line/rtu_assembler.hpp"

namespace ex9000 {

namespace {

constexpr std::uint16_t kShortestFrame = 4;
constexpr std::uint8_t kCrcBytes = 2;
constexpr std::uint8_t kTurnAround = 0x00;
constexpr std::uint8_t kBroadcast = 0;

/// Modbus 0x3038, read with 03 or 04 and quantity 0 or 1: "Send Host OK" (manuals, Modbus part).
bool is_host_ok(Bytes frame) {
  return frame.size == 6 && (frame[1] == 0x03 || frame[1] == 0x04) && frame.word(2) == 0x3038 &&
         frame.word(4) <= 1;
}

}  // namespace

void RtuAssembler::open() {
  whole_ = Crc16();
  behind_first_ = Crc16();
  rest_spoiled_ = overrun_ = false;
}

Verdict RtuAssembler::byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, std::uint8_t own_address,
                           Time now) {
  Verdict before = Verdict::Open;
  if (received_ != 0) {
    const Duration since_last = now.since(last_);
    if (!(since_last < timing_.rtu_silence)) {
      before = late(queue, own_address, since_last);
    }
    if (received_ != 0 && timing_.rtu_slack < since_last) {
      // Behind the first byte the gap may be one behind a turn-around 00, which does not spoil what follows.
      (received_ == 1 ? first_spoiled_ : rest_spoiled_) = true;
    }
  }
  lapsed_ = false;
  last_ = now;

  Frame& frame = queue.assembling();
  if (received_ == 0) {
    open();
    first_spoiled_ = status != ByteStatus::Good;
    turned_around_ = byte == kTurnAround;
  } else {
    rest_spoiled_ |= status != ByteStatus::Good;
    if (turned_around_) {
      behind_first_.add(byte);
    }
  }
  overrun_ |= status == ByteStatus::Overrun;
  whole_.add(byte);
  if (received_ < frame.storage.size()) {
    frame.storage[received_] = byte;
  }
  if (received_ <= frame.storage.size()) {
    ++received_;  // stops one beyond the longest, which is too long whatever follows
  }
  return before;
}

/// A byte came after T3.5: a frame that is right was over and only its timer interrupt is late; any other is
/// over where the byte began after T3.5 too.
Verdict RtuAssembler::late(FrameQueue& queue, std::uint8_t own_address, Duration since_last) {
  const std::uint8_t begin = start(queue.assembling());
  if (begin == kNowhere && since_last < timing_.rtu_separate) {
    return Verdict::Open;
  }
  return end(queue, begin, own_address);
}

Verdict RtuAssembler::silence(FrameQueue& queue, std::uint8_t own_address, Time now) {
  if (received_ == 0 || now.since(last_) < timing_.rtu_silence) {
    return Verdict::Open;
  }
  const std::uint8_t begin = start(queue.assembling());
  if (begin == kNowhere && !lapsed_) {
    lapsed_ = true;
    return Verdict::Open;
  }
  return end(queue, begin, own_address);
}

Verdict RtuAssembler::end(FrameQueue& queue, std::uint8_t start, std::uint8_t own_address) {
  const Verdict verdict = start == kNowhere ? why_lost() : accept(queue, start, own_address);
  close();
  return verdict;
}

Verdict RtuAssembler::cut_off(FrameQueue& queue, std::uint8_t own_address) {
  if (received_ != 0) {
    const std::uint8_t begin = start(queue.assembling());
    if (begin != kNowhere) {
      return end(queue, begin, own_address);
    }
  }
  close();
  return Verdict::Open;
}

std::uint8_t RtuAssembler::start(const Frame& frame) const {
  if (rest_spoiled_) {
    return kNowhere;
  }
  if (!first_spoiled_ && received_ >= kShortestFrame && received_ <= kLongestFrame && whole_.value() == 0) {
    return 0;
  }
  if (frame.storage[0] == kTurnAround && received_ > kShortestFrame && received_ <= kLongestFrame + 1 &&
      behind_first_.value() == 0) {
    return 1;
  }
  return kNowhere;
}

Verdict RtuAssembler::why_lost() const {
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

Verdict RtuAssembler::accept(FrameQueue& queue, std::uint8_t start, std::uint8_t own_address) {
  Frame& frame = queue.assembling();
  const std::uint8_t address = frame.storage[start];
  if (address != own_address && address != kBroadcast) {
    return Verdict::Foreign;
  }
  frame.offset = start;
  frame.size = static_cast<std::uint8_t>(received_ - start - kCrcBytes);
  frame.received = last_;
  if (is_host_ok(frame.bytes())) {
    return Verdict::HostOk;
  }
  return queue.complete_in_interrupt() ? Verdict::Accepted : Verdict::NoRoom;
}

}  // namespace ex9000
