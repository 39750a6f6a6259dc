#include "firmware/line/rtu_assembler.hpp"

namespace ex9000 {

namespace {

constexpr std::uint16_t kShortestFrame = 4;
constexpr std::uint8_t kCrcBytes = 2;
constexpr std::uint8_t kTurnAround = 0x00;
/// One beyond the longest that is stored, and it stays there.
constexpr std::uint16_t kTooLong = kLongestFrame + 2;
constexpr std::uint8_t kBroadcast = 0;
constexpr unsigned kHostOkSize = 6;

/// Modbus 0x3038, read with 03 or 04 and quantity 0 or 1: "Send Host OK" (manuals, Modbus part).
bool is_host_ok(Bytes frame) {
  return (frame[1] == 0x03 || frame[1] == 0x04) && frame.word(2) == 0x3038 && frame.word(4) <= 1;
}

}  // namespace

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
      spoiled_ |= received_ == 1 ? kFirst : kRest;
    }
  }
  lapsed_ = false;
  last_ = now;

  if (received_ == 0) {
    whole_ = Crc16();
    behind_first_ = Crc16();
    spoiled_ = 0;
    turned_around_ = byte == kTurnAround;
  } else if (turned_around_) {
    behind_first_.add(byte);
  }
  if (status != ByteStatus::Good) {
    spoil(status);
  }
  whole_.add(byte);
  Frame& frame = queue.assembling();
  if (received_ < frame.storage.size()) {
    frame.storage[received_++] = byte;
  } else {
    received_ = kTooLong;
  }
  return before;
}

void RtuAssembler::spoil(ByteStatus status) {
  spoiled_ |= received_ == 0 ? kFirst : kRest;
  if (status == ByteStatus::Overrun) {
    spoiled_ |= kOverrun;
  }
}

/// A byte came after T3.5: a frame that is right was over and only its timer interrupt is late; any other is
/// over where the byte began after T3.5 too.
Verdict RtuAssembler::late(FrameQueue& queue, std::uint8_t own_address, Duration since_last) {
  const Verdict verdict = conclude(queue, own_address);
  return verdict == Verdict::Open && !(since_last < timing_.rtu_separate) ? lose() : verdict;
}

Verdict RtuAssembler::silence(FrameQueue& queue, std::uint8_t own_address) {
  if (received_ == 0) {
    return Verdict::Open;
  }
  const Verdict verdict = conclude(queue, own_address);
  if (verdict != Verdict::Open) {
    return verdict;
  }
  if (lapsed_) {
    return lose();
  }
  lapsed_ = true;
  return Verdict::Open;
}

Verdict RtuAssembler::cut_off(FrameQueue& queue, std::uint8_t own_address) {
  const Verdict verdict = received_ == 0 ? Verdict::Open : conclude(queue, own_address);
  close();
  return verdict;
}

/// Ends the open frame where a CRC is right, from its beginning or from behind a turn-around 00.
Verdict RtuAssembler::conclude(FrameQueue& queue, std::uint8_t own_address) {
  const unsigned beyond_shortest = unsigned{received_} - kShortestFrame;
  unsigned start = 0;
  if (spoiled_ != 0 || beyond_shortest > kLongestFrame - kShortestFrame || whole_.value() != 0) {
    if (!turned_around_ || (spoiled_ & kRest) != 0 || beyond_shortest - 1U > kLongestFrame - kShortestFrame ||
        behind_first_.value() != 0) {
      return Verdict::Open;
    }
    start = 1;
  }
  const unsigned size = received_ - start - kCrcBytes;
  close();
  Frame& frame = queue.assembling();
  const std::uint8_t address = frame.storage[start];
  if (address != own_address && address != kBroadcast) {
    return Verdict::Foreign;
  }
  frame.offset = static_cast<std::uint8_t>(start);
  frame.size = static_cast<std::uint8_t>(size);
  frame.received = last_;
  if (size == kHostOkSize && is_host_ok(frame.bytes())) {
    return Verdict::HostOk;
  }
  return queue.complete_in_interrupt() ? Verdict::Accepted : Verdict::NoRoom;
}

/// Ends the open frame, which is nothing.
Verdict RtuAssembler::lose() {
  const Verdict verdict = why_lost();
  close();
  return verdict;
}

Verdict RtuAssembler::why_lost() const {
  if ((spoiled_ & kOverrun) != 0) {
    return Verdict::Overrun;
  }
  if (spoiled_ != 0) {
    return Verdict::LineError;
  }
  if (received_ < kShortestFrame) {
    return Verdict::TooShort;
  }
  return received_ > kLongestFrame ? Verdict::TooLong : Verdict::BadCheck;
}

}  // namespace ex9000
