#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/line_monitor/log/bus_log.hpp"
#include "sim/text/durations.hpp"

namespace ex9000::sim {

namespace {

class TextLog final : public BusLog {
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

}  // namespace

std::unique_ptr<BusLog> text_log(StationNames names, BusLog::Print print) {
  return std::make_unique<TextLog>(std::move(names), std::move(print));
}

}  // namespace ex9000::sim
