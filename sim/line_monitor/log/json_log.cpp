#include "sim/line_monitor/log/json_log.hpp"

#include <nlohmann/json.hpp>

#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

using Object = nlohmann::ordered_json;

double seconds(VirtualTime time) { return std::chrono::duration<double>(time).count(); }

/// Returns the object as one line of text. Replaces invalid UTF-8, because the name of a line may be a path,
/// and a path may contain invalid UTF-8.
std::string text_of(const Object& object) {
  return object.dump(-1, ' ', false, Object::error_handler_t::replace);
}

}  // namespace

void JsonLog::frame(const Frame& frame) {
  Object object{{"time", seconds(frame.began)},
                {"line", line_},
                {"from", names_.of(frame.station)},
                {"bytes", hex_text(frame.bytes)}};
  if (looks_like_dcon(frame.bytes)) {
    object["text"] = std::string(frame.bytes.begin(), frame.bytes.end());
  }
  const bool clear = !frame.collided && names_.know(frame.station);
  const std::string means = !clear ? "" : meaning(frame.bytes, frame.speaker());
  if (!means.empty()) {
    object["meaning"] = means;
  }
  const std::string error = names_.know(frame.station) ? errors(frame) : line_error(frame);
  if (!error.empty()) {
    object["error"] = error;
  }
  object["collided"] = frame.collided;
  print_(text_of(object));
}

void JsonLog::note(VirtualTime now, const std::string& text) {
  print_(text_of({{"time", seconds(now)}, {"line", line_}, {"note", text}}));
}

}  // namespace ex9000::sim
