// How bytes become frames, and replies leave.
#include "tests/world/possible.hpp"

#include <algorithm>

#include "tests/oracles/reference/modbus_check.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"
#include "tests/world/limits.hpp"

namespace ex9000::world {

namespace {

using std::chrono::microseconds;

constexpr std::size_t kLongestFrame = 256;
/// No module has room for so many frames.
constexpr std::size_t kMostWaiting = 4;

}  // namespace

/// The time of this many half bits at the present rate.
Time Possible::half_bits(unsigned count) const { return Time(count * 500'000'000ULL / module_.rate()); }

/// From the end of the first stop bit to the end of the last one.
Time Possible::stop_bits_left() const { return half_bits(module_.format() == LineFormat::k8N2 ? 2 : 0); }

/// wire.md D18 and D11: the silence before a reply, and the one that ends a frame of RTU.
Time Possible::gap() const {
  return !module_.runs_modbus()   ? half_bits(2 * reference::character_bits(module_.format()))
         : module_.rate() > 19200 ? Time(microseconds(1750))
                                  : half_bits(77);
}

/// Modbus: whether the open bytes are a frame with a right check.
bool Possible::is_whole() const {
  const auto right_from = [this](std::size_t first) {
    const Bytes frame(open_.begin() + static_cast<std::ptrdiff_t>(first), open_.end());
    return frame.size() >= 4 && frame.size() <= kLongestFrame && reference::crc_is_right(frame) &&
           std::find(bad_.begin() + static_cast<std::ptrdiff_t>(first), bad_.end(), true) == bad_.end();
  };
  return right_from(0) || (open_[0] == 0 && right_from(1));
}

/// Modbus: when the open frame ends, without the uncertainty of the clocks (wire.md D11).
Time Possible::frame_limit() const {
  const unsigned received =
      reference::character_bits(module_.format()) - (module_.format() == LineFormat::k8N2 ? 1 : 0);
  return last_ + stop_bits_left() + gap() + (is_whole() ? Time(0) : half_bits(2 * received));
}

/// The open frame is complete.
std::vector<Possible> Possible::frame_ends(Moment received, Moment judged) const {
  Possible next = *this;
  const Waiting frame{open_, bad_, last_ + stop_bits_left(), judged};
  next.open_.clear();
  next.bad_.clear();
  const bool concerns = next.module_.on_receipt(frame.bytes, frame.bad, received);
  const std::string text(frame.bytes.begin(), frame.bytes.end());
  const std::size_t prefix =
      reference::Module::is_by_number(frame.bytes) ||
              (frame.bytes[0] == 0 &&
               reference::Module::is_by_number({frame.bytes.begin() + 1, frame.bytes.end()}))
          ? 6
          : 0;
  const bool host_ok =
      module_.runs_modbus()
          ? is_whole() &&
                (frame.bytes.size() == 8 + prefix ||
                 (frame.bytes[0] == 0 && frame.bytes.size() == 9 + prefix)) &&  // after a turn-around byte
                reference::word(frame.bytes, frame.bytes.size() - 6) == 0x3038 &&
                (frame.bytes[frame.bytes.size() - 7] == 3 || frame.bytes[frame.bytes.size() - 7] == 4) &&
                reference::word(frame.bytes, frame.bytes.size() - 4) <= 1
          : text.substr(0, 3) == "~**";
  if (concerns && host_ok) {
    next.module_.on_frame(frame.bytes, frame.bad, received);
  }
  const bool executed = concerns && !host_ok && !hung_;
  // wire.md 8: while a command is executed, at least one more frame is kept. Broadcasts that change
  // nothing need no room.
  const std::size_t others = waiting_.size() + (due_ || sending_ || hangs(received.earliest) ? 1 : 0);
  const bool may_be_lost = executed && others >= 2;
  std::vector<Possible> each_way{next};
  // A lost frame need not restart the host watchdog. A main loop that hung may see the end of the timeout
  // later than a frame that came too late.
  const auto& expiry = module_.expiry();
  if (expiry && next.module_.expiry()) {
    if (expiry->latest < received.earliest) {
      each_way[0].module_.keep_expiry(*expiry);
    } else if (may_be_lost || expiry->earliest <= received.latest) {
      each_way.push_back(next);
      each_way.back().module_.keep_expiry(*expiry);
    }
  }
  std::vector<Possible> after;
  if (executed && due_ && due_->takes_address) {  // wire.md D16: it was perhaps not in force yet
    after.push_back(next);
    after.back().module_.miss_frame();
    if (expiry && next.module_.expiry()) {
      after.back().module_.keep_expiry(*expiry);
    }
  }
  for (Possible& each : each_way) {
    if (may_be_lost) {
      after.push_back(each);
      after.back().module_.lose_frame();
    }
    if (executed && others < kMostWaiting) {
      each.waiting_.push_back(frame);
    }
    if (!executed || others < kMostWaiting) {
      after.push_back(each);
    }
  }
  return after;
}

std::vector<Possible> Possible::hear(std::uint8_t byte, bool good, Time end) const {
  Possible next = *this;
  if (!good) {
    next.module_.on_bad_byte();
  }
  if (module_.runs_modbus()) {
    if (next.open_.size() < kLongestFrame + 44) {
      next.open_.push_back(byte);
      next.bad_.push_back(!good);
    }
    next.last_ = end;
    return {next};
  }
  if (open_.empty()) {
    if (!good) {
      return {next};
    }
    if (skipping_) {
      next.skipping_ = byte != '\r';
    } else if (std::string("#$%@~").find(static_cast<char>(byte)) != std::string::npos) {
      next.open_ = {byte};
      next.bad_ = {false};
    } else {
      next.skipping_ = std::string("!>?").find(static_cast<char>(byte)) != std::string::npos;
    }
    return {next};
  }
  next.open_.push_back(byte);
  next.bad_.push_back(!good);
  next.last_ = end;
  if (byte != '\r' || !good) {
    return {next};
  }
  const Time due = end + stop_bits_left() + gap();
  return next.frame_ends({end, end + kExact}, {due - kExact, due + kExact});
}

std::vector<Possible> Possible::reply(const Bytes& bytes, Time begins) const {
  if (!due_ || due_->bytes != bytes || begins < due_->begins.earliest || begins < replied_ + gap() - kExact ||
      begins > std::max(due_->begins.latest, hangs_until_ + kReplies)) {
    return {};
  }
  Possible next = *this;
  next.due_.reset();
  next.sending_ = true;
  next.skipping_ = false;
  // wire.md D9
  if (module_.runs_modbus() && !open_.empty() && is_whole()) {
    const Moment judged{begins, frame_limit() + kExact};
    return next.frame_ends(judged, judged);
  }
  std::vector<Possible> after{next};
  if (!open_.empty()) {  // wire.md does not say whether the dropped frame counts
    after.push_back(next);
    after.back().module_.count_remains();
  }
  for (Possible& each : after) {
    each.open_.clear();
    each.bad_.clear();
  }
  return after;
}

void Possible::replied(Time end) {
  if (sending_) {  // a reset has not cut the reply off
    module_.replied();
  }
  sending_ = false;
  free_ = replied_ = end;
  if (!activates()) {
    activates_since_.reset();
  } else if (!activates_since_ || (*activates_since_ == kSometime && !module_.update().activates)) {
    activates_since_ = end;
  }
}

}  // namespace ex9000::world
