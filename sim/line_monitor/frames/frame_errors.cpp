#include "sim/line_monitor/frames/frame_errors.hpp"

#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

std::string error_text(ByteStatus status) {
  switch (status) {
    case ByteStatus::FramingError:
      return "framing error";
    case ByteStatus::ParityError:
      return "parity error";
    default:
      return "";
  }
}

std::string told(const Frame::Change& change) {
  const std::string sent = hex_byte_text(change.sent);
  const std::string which = "byte " + std::to_string(change.position + 1) + ": ";
  const auto byte = change.byte();
  if (!byte) {
    return which + sent + " is lost because its start bit is missing";
  }
  if (change.status() == ByteStatus::Break) {
    return which + "break instead of " + sent;
  }
  const std::string instead = *byte == change.sent ? "" : hex_byte_text(*byte) + " instead of " + sent;
  const std::string error = error_text(change.status());
  return which + error + (error.empty() || instead.empty() ? "" : ", ") + instead;
}

void append(std::string& text, const std::string& more) {
  if (!more.empty()) {
    text += (text.empty() ? "" : "; ") + more;
  }
}

}  // namespace

std::string line_error(const Frame& frame) {
  std::string changes;
  for (const Frame::Change& change : frame.changes) {
    append(changes, told(change));
  }
  std::string text = frame.collided ? "collision: another station drove the line at the same time" : "";
  if (!hear_each_other(frame.sent_in, frame.line_in)) {
    append(text, "sent at " + mode_text(frame.sent_in.baud, frame.sent_in.format) + " on a line at " +
                     mode_text(frame.line_in.baud, frame.line_in.format));
  }
  append(text, changes.empty() ? "" : "noise: " + changes);
  return text;
}

std::string errors(const Frame& frame) {
  std::string text = line_error(frame);
  if (!frame.collided) {
    append(text, check_error(frame.bytes, frame.speaker()));
  }
  return text;
}

}  // namespace ex9000::sim
