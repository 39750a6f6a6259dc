#include "sim/bus_log.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <utility>

namespace ex9000::sim {

namespace {

/// A master's writes may come in pieces, and a person thinks between two keys.
constexpr VirtualTime kPatienceForRest = std::chrono::milliseconds(5);
constexpr VirtualTime kPatienceForTyping = std::chrono::seconds(5);

/// Seconds with six decimals, right-aligned.
std::string stamp(VirtualTime time) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(6) << std::setw(12) << std::chrono::duration<double>(time).count();
  return text.str();
}

}  // namespace

BusLog::BusLog(std::vector<std::string> speakers, Print print)
    : speakers_(std::move(speakers)), print_(std::move(print)), frames_(speakers_.size()) {}

void BusLog::byte(std::size_t station, std::uint8_t byte, std::uint32_t baud, bool collided,
                  VirtualTime start, VirtualTime end) {
  Frame& frame = frame_of(station);
  if (frame.bytes.empty()) {
    frame.began = start;
  }
  frame.bytes.push_back(byte);
  frame.collided |= collided;
  frame.prints = kNever;
  constexpr std::size_t kLongest = 300;
  const bool dcon = looks_like_dcon(frame.bytes);
  if ((dcon && byte == '\r') || frame.bytes.size() >= kLongest) {
    print(station);
  } else {
    constexpr VirtualTime kFourCharacters{40'000'000'000};  // bits in nanoseconds, at 1 baud
    frame.prints = end + (dcon ? kPatienceForTyping : std::max(kPatienceForRest, kFourCharacters / baud));
  }
}

/// What faults put on a line is attached to it behind the modules, and has no name.
BusLog::Frame& BusLog::frame_of(std::size_t station) {
  if (station >= frames_.size()) {
    frames_.resize(station + 1);
  }
  return frames_[station];
}

void BusLog::driver(std::size_t station, bool on, VirtualTime /*now*/) {
  if (!on && station != 0) {
    print(station);
  }
  if (on && station != 0 && !looks_like_dcon(frames_[0].bytes)) {
    print(0);  // somebody answers, so the request was over
  }
}

VirtualTime BusLog::next() const {
  VirtualTime next = kNever;
  for (const Frame& frame : frames_) {
    next = std::min(next, frame.prints);
  }
  return next;
}

void BusLog::run(VirtualTime now) {
  for (std::size_t station = 0; station < frames_.size(); ++station) {
    if (frames_[station].prints <= now) {
      print(station);
    }
  }
}

void BusLog::print(std::size_t station) {
  const Frame frame = std::exchange(frame_of(station), Frame());
  if (frame.bytes.empty()) {
    return;
  }
  if (station >= speakers_.size()) {
    print_(stamp(frame.began) + "  ? somebody else  " + shown(frame.bytes));
    return;
  }
  const Speaker speaker = station == 0 ? Speaker::Master : Speaker::Module;
  std::string line =
      stamp(frame.began) + (station == 0 ? "  > " : "  < ") + speakers_[station] + "  " + shown(frame.bytes);
  const std::string means = frame.collided ? "collision: two drivers were on" : meaning(frame.bytes, speaker);
  if (!means.empty()) {
    line += "  ; " + means;
  }
  print_(line);
}

void BusLog::note(VirtualTime now, const std::string& text) { print_(stamp(now) + "  - " + text); }

}  // namespace ex9000::sim
