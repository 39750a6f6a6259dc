#include "sim/frames/frame_errors.hpp"

#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

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
  const std::string instead = hex_byte_text(*byte) + " instead of " + sent;
  return which + (change.status() == ByteStatus::FramingError ? "framing error, " : "") + instead;
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
  if (frame.sent_at != frame.line_at) {
    append(text, "sent at " + std::to_string(frame.sent_at) + " baud on a line at " +
                     std::to_string(frame.line_at));
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
