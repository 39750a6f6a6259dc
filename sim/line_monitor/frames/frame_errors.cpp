#include "sim/line_monitor/frames/frame_errors.hpp"

#include <algorithm>
#include <iterator>

#include "firmware/line/timing.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

std::string told(const Frame::Change& change) {
  const std::string sent = hex_byte_text(change.sent);
  const std::string which = "byte " + std::to_string(change.position + 1) + ": ";
  const auto byte = change.byte();
  if (!byte) {
    return which + sent + " is lost because its start bit is missing";
  }
  const ByteStatus status = change.status();
  if (status == ByteStatus::Break) {
    return which + "break instead of " + sent;
  }
  Words parts;
  if (status != ByteStatus::Good) {
    parts.emplace_back(status == ByteStatus::FramingError ? "framing error" : "parity error");
  }
  if (*byte != change.sent) {
    parts.push_back(hex_byte_text(*byte) + " instead of " + sent);
  }
  return which + joined(parts, ", ");
}

/// What a window of an arbitration is longer than a byte.
VirtualTime room_in_window(SerialMode mode) {
  if (mode.baud == 0) {
    return kNever;
  }
  const LineTiming timing = LineTiming::at(mode.baud, mode.format);
  return std::chrono::microseconds((timing.windows(1) - timing.character).microseconds());
}

}  // namespace

std::string line_error(const Frame& frame) {
  Words parts;
  if (frame.collided) {
    parts.emplace_back("collision: another station drove the line at the same time");
  }
  if (frame.skew > room_in_window(frame.sent_in)) {
    parts.push_back("modules begin the same window " + time_text(frame.skew) +
                    " apart, so that not all bytes end in it");
  }
  if (!hear_each_other(frame.sent_in, frame.line_in)) {
    parts.push_back("sent at " + mode_text(frame.sent_in.baud, frame.sent_in.format) + " on a line at " +
                    mode_text(frame.line_in.baud, frame.line_in.format));
  }
  if (!frame.changes.empty()) {
    Words changes;
    std::transform(frame.changes.begin(), frame.changes.end(), std::back_inserter(changes), told);
    parts.push_back("noise: " + joined(changes, "; "));
  }
  return joined(parts, "; ");
}

std::string errors(const Frame& frame) {
  const std::string on_the_line = line_error(frame);
  const std::string in_the_bytes = frame.collided ? "" : check_error(frame.bytes, frame.speaker());
  return on_the_line + (on_the_line.empty() || in_the_bytes.empty() ? "" : "; ") + in_the_bytes;
}

}  // namespace ex9000::sim
