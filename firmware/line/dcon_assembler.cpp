#include "firmware/line/dcon_assembler.hpp"

#include "firmware/hex.hpp"

namespace ex9000 {

namespace {

constexpr std::uint8_t kDelimiterAndAddress = 3;
constexpr std::uint8_t kChecksumDigits = 2;

constexpr bool is_delimiter(std::uint8_t byte) {
  return byte == '#' || byte == '$' || byte == '%' || byte == '@' || byte == '~';
}

constexpr bool is_reply_lead(std::uint8_t byte) { return byte == '!' || byte == '>' || byte == '?'; }

/// `digits`: in the format of `hex_digits`.
bool are_digits(const std::uint8_t* text, std::uint32_t digits) {
  return (unsigned{text[0]} | unsigned{text[1]} << 8U) == digits;
}

}  // namespace

void DconAssembler::byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status) {
  if (status != ByteStatus::Good) {
    spoil(status);
  } else if (state_ == State::InFrame) {
    if (size_ == kLongestDconFrame) {
      state_ = State::Spoiled;
      loss_ = Verdict::TooLong;
    } else {
      add(queue.assembling().storage.data(), byte);
    }
  } else if (state_ == State::Hunting) {
    open_or_skip(queue, byte);
  }
}

/// A byte with an error is unreliable, or another was lost: it neither ends nor begins a frame.
void DconAssembler::spoil(ByteStatus status) {
  if (state_ == State::InFrame) {
    state_ = State::Spoiled;
    loss_ = status == ByteStatus::Overrun ? Verdict::Overrun : Verdict::LineError;
  }
}

/// The sum excludes the last two characters, which may be the checksum.
void DconAssembler::add(std::uint8_t* text, std::uint8_t byte) {
  const unsigned size = size_;
  text[size] = byte;
  size_ = static_cast<std::uint8_t>(size + 1);
  if (size >= kChecksumDigits) {
    sum_ = static_cast<std::uint8_t>(sum_ + text[size - kChecksumDigits]);
  }
}

void DconAssembler::open_or_skip(FrameQueue& queue, std::uint8_t byte) {
  if (is_delimiter(byte)) {
    queue.assembling().storage[0] = byte;
    size_ = 1;
    sum_ = 0;
    state_ = State::InFrame;
  } else if (is_reply_lead(byte)) {
    state_ = State::Skipping;
  }
}

Verdict DconAssembler::end(FrameQueue& queue, ByteStatus status, Time now) {
  if (status != ByteStatus::Good) {
    spoil(status);
    return Verdict::Open;
  }
  const State ended = state_;
  state_ = State::Hunting;
  if (ended == State::InFrame) {
    return judge(queue, now);
  }
  return ended == State::Spoiled ? loss_ : Verdict::Open;
}

Verdict DconAssembler::judge(FrameQueue& queue, Time now) {
  Frame& frame = queue.assembling();
  const std::uint8_t* text = frame.storage.data();
  unsigned size = size_;
  if (checksum_) {
    if (size <= kChecksumDigits) {
      return Verdict::TooShort;
    }
    size -= kChecksumDigits;
    if (!are_digits(text + size, hex_digits(sum_))) {
      return Verdict::BadCheck;
    }
  }
  if (size < kDelimiterAndAddress) {
    return Verdict::Foreign;  // the frame has no address, so it is for no module
  }
  broadcast_ = !are_digits(text + 1, own_digits_.load());
  if (broadcast_) {
    constexpr std::uint16_t kEverybody = '*' | '*' << 8U;
    if (!are_digits(text + 1, kEverybody)) {
      return Verdict::Foreign;
    }
    if (size != kDelimiterAndAddress || (text[0] != '~' && text[0] != '#')) {
      return Verdict::Ignored;
    }
    if (text[0] == '~') {
      return Verdict::HostOk;
    }
  }
  frame.offset = 0;
  frame.size = static_cast<std::uint16_t>(size);
  frame.received = now;
  return queue.complete_in_interrupt() ? Verdict::Accepted : Verdict::NoRoom;
}

}  // namespace ex9000
