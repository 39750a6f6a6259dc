#include "firmware/line/dcon_assembler.hpp"

#include "firmware/hex.hpp"

namespace ex9000 {

namespace {

constexpr std::uint8_t kCarriageReturn = '\r';
constexpr std::uint8_t kDelimiterAndAddress = 3;
constexpr std::uint8_t kChecksumDigits = 2;

constexpr bool is_delimiter(std::uint8_t byte) {
  return byte == '#' || byte == '$' || byte == '%' || byte == '@' || byte == '~';
}

constexpr bool is_reply_lead(std::uint8_t byte) { return byte == '!' || byte == '>' || byte == '?'; }

}  // namespace

Verdict DconAssembler::byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, std::uint8_t own_address,
                            Time now) {
  // A CR that came with an error may have been anything, so it ends nothing.
  const bool ends = byte == kCarriageReturn && status == ByteStatus::Good;
  switch (state_) {
    case State::Hunting:
      open_or_skip(queue, byte, status);
      return Verdict::Open;
    case State::Skipping:
      if (ends) {
        state_ = State::Hunting;
      }
      return Verdict::Open;
    case State::Spoiled:
      if (!ends) {
        return Verdict::Open;
      }
      state_ = State::Hunting;
      return loss_;
    case State::InFrame:
      break;
  }
  if (ends) {
    state_ = State::Hunting;
    return judge(queue, own_address, now);
  }
  if (status != ByteStatus::Good || size_ == kLongestDconFrame) {
    state_ = State::Spoiled;
    loss_ = status == ByteStatus::Good ? Verdict::TooLong : Verdict::LineError;
    return Verdict::Open;
  }
  queue.assembling().storage[size_++] = byte;
  sum_ = static_cast<std::uint8_t>(sum_ + byte);
  return Verdict::Open;
}

void DconAssembler::open_or_skip(FrameQueue& queue, std::uint8_t byte, ByteStatus status) {
  if (status != ByteStatus::Good) {
    return;
  }
  if (is_delimiter(byte)) {
    queue.assembling().storage[0] = byte;
    size_ = 1;
    sum_ = byte;
    state_ = State::InFrame;
  } else if (is_reply_lead(byte)) {
    state_ = State::Skipping;
  }
}

Verdict DconAssembler::judge(FrameQueue& queue, std::uint8_t own_address, Time now) {
  Frame& frame = queue.assembling();
  const auto& text = frame.storage;
  std::uint8_t size = size_;
  if (size < kDelimiterAndAddress + (checksum_ ? kChecksumDigits : 0)) {
    return Verdict::TooShort;
  }
  if (checksum_) {
    size = static_cast<std::uint8_t>(size - kChecksumDigits);
    const auto sum = static_cast<std::uint8_t>(sum_ - text[size] - text[size + 1U]);
    if (hex_byte(text[size], text[size + 1U]) != sum) {
      return Verdict::BadCheck;
    }
  }
  if (text[1] == '*' && text[2] == '*' && size == kDelimiterAndAddress) {
    if (text[0] == '~') {
      return Verdict::HostOk;
    }
    if (text[0] != '#') {
      return Verdict::Foreign;
    }
  } else if (hex_byte(text[1], text[2]) != own_address) {
    return Verdict::Foreign;
  }
  frame.size = size;
  frame.offset = 0;
  frame.received = now;
  return queue.complete_in_interrupt() ? Verdict::Accepted : Verdict::NoRoom;
}

}  // namespace ex9000
