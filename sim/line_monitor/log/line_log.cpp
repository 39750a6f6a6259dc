#include "sim/line_monitor/log/line_log.hpp"

#include <nlohmann/json.hpp>

#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

class TextLog final : public LineLog {
 public:
  TextLog(StationNames names, Print print) : names_(std::move(names)), print_(std::move(print)) {}

  void frame(const Frame& frame) override {
    const bool known = names_.know(frame.station);
    const std::string mark = frame.speaker() == Speaker::Master ? "  > " : known ? "  < " : "  ? ";
    const std::string error = line_error(frame);
    // The bytes of a collided frame or of an unknown station have no known meaning.
    const std::string means = frame.collided || !known ? "" : meaning(frame.bytes, frame.speaker());
    const std::string remarks = error + (error.empty() || means.empty() ? "" : "; ") + means;
    print_(stamp_text(frame.began) + mark + names_.of(frame.station) + "  " + shown(frame.bytes) +
           (remarks.empty() ? "" : "  ; " + remarks));
  }

  void note(VirtualTime now, const std::string& text) override { print_(note_text(now, text)); }

 private:
  StationNames names_;
  Print print_;
};

using Object = nlohmann::ordered_json;

double seconds(VirtualTime time) { return std::chrono::duration<double>(time).count(); }

/// Replaces invalid UTF-8: the name of a line may be a path, which may contain it.
std::string text_of(const Object& object) {
  return object.dump(-1, ' ', false, Object::error_handler_t::replace);
}

class JsonLog final : public LineLog {
 public:
  JsonLog(std::string line, StationNames names, Print print)
      : line_(std::move(line)), names_(std::move(names)), print_(std::move(print)) {}

  void frame(const Frame& frame) override {
    Object object{{"time", seconds(frame.began)},
                  {"line", line_},
                  {"from", names_.of(frame.station)},
                  {"bytes", hex_text(frame.bytes)}};
    if (looks_like_dcon(frame.bytes)) {
      object["text"] = std::string(frame.bytes.begin(), frame.bytes.end());
    }
    const bool known = names_.know(frame.station);
    const std::string means = frame.collided || !known ? "" : meaning(frame.bytes, frame.speaker());
    if (!means.empty()) {
      object["meaning"] = means;
    }
    const std::string error = known ? errors(frame) : line_error(frame);
    if (!error.empty()) {
      object["error"] = error;
    }
    object["collided"] = frame.collided;
    print_(text_of(object));
  }

  void note(VirtualTime now, const std::string& text) override {
    print_(text_of({{"time", seconds(now)}, {"line", line_}, {"note", text}}));
  }

 private:
  std::string line_;
  StationNames names_;
  Print print_;
};

}  // namespace

std::unique_ptr<LineLog> text_log(StationNames names, LineLog::Print print) {
  return std::make_unique<TextLog>(std::move(names), std::move(print));
}

std::unique_ptr<LineLog> json_log(std::string line, StationNames names, LineLog::Print print) {
  return std::make_unique<JsonLog>(std::move(line), std::move(names), std::move(print));
}

}  // namespace ex9000::sim
