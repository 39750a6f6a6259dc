#include "sim/line_monitor/log/text_log.hpp"

#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/text/durations.hpp"

namespace ex9000::sim {

namespace {

/// Returns the errors and the meaning of a frame. `known`: the sender is the master or a module. The bytes of
/// a collided frame or of an unknown station have no known meaning.
std::string remarks(const Frame& frame, bool known) {
  const std::string error = line_error(frame);
  const std::string means = frame.collided || !known ? "" : meaning(frame.bytes, frame.speaker());
  return error + (error.empty() || means.empty() ? "" : "; ") + means;
}

}  // namespace

void TextLog::frame(const Frame& frame) {
  const bool known = names_.know(frame.station);
  const std::string mark = frame.speaker() == Speaker::Master ? "  > " : known ? "  < " : "  ? ";
  std::string line = stamp_text(frame.began) + mark + names_.of(frame.station) + "  " + shown(frame.bytes);
  const std::string remark = remarks(frame, known);
  if (!remark.empty()) {
    line += "  ; " + remark;
  }
  print_(line);
}

void TextLog::note(VirtualTime now, const std::string& text) { print_(note_text(now, text)); }

}  // namespace ex9000::sim
