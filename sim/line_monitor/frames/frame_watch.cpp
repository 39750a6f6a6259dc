#include "sim/line_monitor/frames/frame_watch.hpp"

#include <algorithm>
#include <utility>

#include "firmware/line/crc16.hpp"
#include "firmware/line/rtu_frames.hpp"
#include "firmware/line/timing.hpp"

namespace ex9000::sim {

namespace {

constexpr std::size_t kMaster = 0;

// The longest pauses inside a frame: of a master that writes it in pieces (four characters, if they take
// longer), and of a person who types it.
constexpr VirtualTime kLongestPauseInWrite = std::chrono::milliseconds(5);
constexpr VirtualTime kLongestPauseInTyping = std::chrono::seconds(5);

}  // namespace

FrameWatch::Sender& FrameWatch::sender(std::size_t station) {
  if (senders_.size() <= station) {
    senders_.resize(station + 1);
  }
  return senders_[station];
}

/// A time limit cannot tell: gaps between requests without a reply may be shorter than inside one request.
bool FrameWatch::begins_another(VirtualTime start, VirtualTime end) {
  constexpr std::size_t kShortest = 4;
  const Frame& frame = sender(kMaster).frame;
  const VirtualTime character = end - start;
  return frame.bytes.size() >= kShortest && (start - frame.ended) * 2 > character * 3 &&
         crc16({frame.bytes.data(), frame.bytes.size()}).value() == 0;
}

void FrameWatch::changed(std::size_t station, Levels arrives) { sender(station).change = arrives; }

void FrameWatch::byte(std::size_t station, std::uint8_t byte, SerialMode mode, bool collided,
                      VirtualTime start, VirtualTime end) {
  if (station != kMaster && byte == modbus::kZeroInWindow && sender(station).sent == 0) {
    burst(station, mode, start, end);
    return;
  }
  end_arbitration();
  if (station == kMaster && begins_another(start, end)) {
    hand_out(kMaster);
  }
  Sender& sending = sender(station);
  Frame& frame = sending.frame;
  if (sending.sent == 0) {
    frame.began = start;
    frame.sent_in = mode;
    frame.line_in = line_mode_();
  }
  std::optional<std::uint8_t> arrives = byte;
  if (const auto levels = std::exchange(sending.change, std::nullopt)) {
    frame.changes.push_back({sending.sent, byte, *levels, mode.format});
    arrives = frame.changes.back().byte();
  }
  if (arrives) {
    frame.bytes.push_back(*arrives);
  }
  ++sending.sent;
  frame.collided |= collided;
  frame.ended = end;
  constexpr std::size_t kLongest = 300;
  const bool dcon = looks_like_dcon(frame.bytes);
  if ((dcon && frame.bytes.back() == '\r') || sending.sent >= kLongest) {
    hand_out(station);
  } else {
    constexpr VirtualTime kFourCharacters{44'000'000'000};  // the time of 44 bits at 1 baud, in ns
    sending.frame_deadline =
        end + (dcon ? kLongestPauseInTyping : std::max(kLongestPauseInWrite, kFourCharacters / mode.baud));
  }
}

/// A byte FF of an arbitration.
void FrameWatch::burst(std::size_t station, SerialMode mode, VirtualTime start, VirtualTime end) {
  sender(station).change.reset();
  Frame& frame = arbitration_.frame;
  if (arbitration_.sent == 0) {
    frame.station = station;
    frame.began = start;
    frame.sent_in = mode;
    frame.line_in = line_mode_();
  }
  if (arbitration_.sent == 0 || start >= frame.ended) {
    frame.bytes.push_back(modbus::kZeroInWindow);
    ++arbitration_.sent;
    last_burst_ = start;
  } else {
    frame.skew = std::max(frame.skew, start > last_burst_ ? start - last_burst_ : last_burst_ - start);
  }
  frame.ended = std::max(frame.ended, end);
  constexpr unsigned kWindows = 32;
  const Duration longest = LineTiming::at(mode.baud, mode.format).windows(kWindows);
  arbitration_.frame_deadline = end + std::chrono::microseconds(longest.microseconds());
}

void FrameWatch::end_arbitration() {
  if (arbitration_.sent != 0) {
    const std::size_t station = arbitration_.frame.station;
    hand_out(arbitration_, station);
  }
}

void FrameWatch::driver(std::size_t station, bool on, VirtualTime /*now*/) {
  if (!on) {
    sender(station).change.reset();  // a byte in progress is cut off, and Wires does not report it
    if (station != kMaster) {
      hand_out(station);
    }
  }
  if (on && station != kMaster && !looks_like_dcon(sender(kMaster).frame.bytes)) {
    hand_out(kMaster);  // another station sends, so the request has ended
  }
}

VirtualTime FrameWatch::next() const {
  VirtualTime next = kNever;
  for (const Sender& each : senders_) {
    next = std::min(next, each.frame_deadline);
  }
  return std::min(next, arbitration_.frame_deadline);
}

void FrameWatch::run(VirtualTime now) {
  for (std::size_t station = 0; station < senders_.size(); ++station) {
    if (senders_[station].frame_deadline <= now) {
      hand_out(station);
    }
  }
  if (arbitration_.frame_deadline <= now) {
    end_arbitration();
  }
}

void FrameWatch::hand_out(std::size_t station) { hand_out(sender(station), station); }

void FrameWatch::hand_out(Sender& sending, std::size_t station) {
  if (std::exchange(sending.sent, 0) == 0) {
    return;
  }
  sending.frame_deadline = kNever;
  Frame frame = std::exchange(sending.frame, {});
  frame.station = station;
  for (const Take& take : takers_) {
    take(frame);
  }
}

}  // namespace ex9000::sim
