#include <nlohmann/json.hpp>

#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/line_monitor/log/bus_log.hpp"
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

class JsonLog final : public BusLog {
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

std::unique_ptr<BusLog> json_log(std::string line, StationNames names, BusLog::Print print) {
  return std::make_unique<JsonLog>(std::move(line), std::move(names), std::move(print));
}

}  // namespace ex9000::sim
