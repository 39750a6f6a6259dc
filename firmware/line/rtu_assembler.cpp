#include "firmware/line/rtu_assembler.hpp"

namespace ex9000 {

namespace {

constexpr unsigned kShortestFrame = 4;
constexpr std::uint8_t kCrcBytes = 2;
constexpr std::uint8_t kTurnAround = 0x00;
/// One beyond the longest that is stored, and it stays there.
constexpr std::uint32_t kTooLong = kLongestFrame + 2;
constexpr std::uint8_t kBroadcast = 0;

/// Bytes beyond the shortest frame; wraps below it.
constexpr unsigned beyond_shortest(unsigned received) { return received - kShortestFrame; }
constexpr unsigned kMostBeyond = kLongestFrame - kShortestFrame;

/// Modbus 0x3038, read with 03 or 04 and quantity 0 or 1: "Send Host OK" (manuals, Modbus part).
bool is_host_ok(Bytes frame) {
  constexpr unsigned kSize = 6;
  return frame.size == kSize && (frame[1] == 0x03 || frame[1] == 0x04) && frame.word(2) == 0x3038 &&
         frame.word(4) <= 1;
}

}  // namespace

Verdict RtuAssembler::byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, Time now) {
  // What is stored may be any of the members, for all that the compiler knows: they are read but once.
  Verdict before = Verdict::Open;
  unsigned received = received_;
  if (received != 0) {
    const Duration since_last = now.since(last_);
    if (!(since_last < gap_)) {
      before = behind_a_gap(queue, since_last);
      received = received_;
    }
  }
  last_ = now;
  Crc16 whole = whole_;
  Frame& frame = queue.assembling();
  if (received == 0) {
    whole = behind_first_ = Crc16();
    gap_ = strict() ? timing_.rtu_slack + Duration(1) : timing_.rtu_silence;
    spoiled_ = 0;
    announced_ = 0;
    first_ = byte;
  } else if (first_ == kTurnAround) {
    behind_first_.add(byte);
  }
  if (status != ByteStatus::Good) {
    spoil(status);
  }
  whole.add(byte);
  whole_ = whole;
  if (received >= frame.storage.size()) {
    received_ = kTooLong;
    lapsed_ = 0;  // this byte came behind it, which the number does not tell
    return before;
  }
  frame.storage[received] = byte;
  received_ = received + 1;
  if (whole.value() == 0 && first_ == own_address_.load()) {
    // This may have been the last byte. Whether it was is for `conclude`.
    frame.offset = 0;
    frame.size = static_cast<std::uint8_t>(received + 1 - kCrcBytes);
    announced_ = received + 1;
    queue.announce_in_interrupt(frame);
  }
  return before;
}

void RtuAssembler::spoil(ByteStatus status) {
  spoiled_ |= received_ == 0 ? kFirst : kRest;
  if (status == ByteStatus::Overrun) {
    spoiled_ |= kOverrun;
  }
}

/// The frame before it may be over. Where it is not, the gap may spoil it; behind the first byte it may be
/// one behind a turn-around 00, which does not spoil what follows.
Verdict RtuAssembler::behind_a_gap(FrameQueue& queue, Duration since_last) {
  Verdict before = Verdict::Open;
  if (lapsed_ == received_ && !(since_last < timing_.rtu_separate)) {
    return lose();  // the CRC was not right then
  }
  if (!(since_last < timing_.rtu_silence)) {
    before = late(queue, since_last);
  }
  if (kBuiltStrictGaps && received_ != 0 && timing_.rtu_slack < since_last) {
    spoiled_ |= received_ == 1 ? kFirst : kRest;
  }
  return before;
}

/// A byte came after T3.5: a frame that is right was over and only its timer interrupt is late; any other is
/// over where the byte began after T3.5 too.
Verdict RtuAssembler::late(FrameQueue& queue, Duration since_last) {
  const Verdict verdict = conclude(queue);
  if (verdict == Verdict::Open && !(since_last < timing_.rtu_separate)) {
    loss_ = why_lost();
    return lose();
  }
  return verdict;
}

Verdict RtuAssembler::lapse() {
  if (received_ == 0) {
    return Verdict::Open;
  }
  if (lapsed_ == received_) {
    return lose();
  }
  lapsed_ = received_;
  loss_ = why_lost();
  if (!strict()) {
    gap_ = timing_.rtu_separate;  // a byte that comes before that goes on with the frame
  }
  return Verdict::Open;
}

Verdict RtuAssembler::cut_off(FrameQueue& queue) {
  const Verdict verdict = received_ == 0 ? Verdict::Open : conclude(queue);
  close();
  return verdict;
}

/// Ends the open frame where a CRC is right, from its beginning or from behind a turn-around 00.
Verdict RtuAssembler::conclude(FrameQueue& queue) {
  const unsigned received = received_;
  unsigned start = 0;
  unsigned address = first_;
  if ((spoiled_ | whole_.value()) != 0) {
    if (first_ != kTurnAround || (spoiled_ & kRest) != 0 || behind_first_.value() != 0) {
      return Verdict::Open;
    }
    start = 1;
    address = queue.assembling().storage[1];
  }
  if (beyond_shortest(received - start) > kMostBeyond) {
    return Verdict::Open;
  }
  close();
  if (address != own_address_.load() && address != kBroadcast) {
    return Verdict::Foreign;
  }
  Frame& frame = queue.assembling();
  const unsigned size = received - start - kCrcBytes;
  if (is_host_ok({frame.storage.data() + start, size})) {
    return Verdict::HostOk;
  }
  frame.received = last_;
  if (announced_ != received) {
    // A broadcast, or a frame behind a turn-around 00, which begins like one.
    frame.offset = static_cast<std::uint8_t>(start);
    frame.size = static_cast<std::uint8_t>(size);
    queue.announce_in_interrupt(frame);
  }
  return queue.complete_in_interrupt(frame) ? Verdict::Accepted : Verdict::NoRoom;
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
