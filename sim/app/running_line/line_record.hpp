// The records of a line: its log and its capture.
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "sim/app/setup/setup.hpp"
#include "sim/line_monitor/capture/capture.hpp"
#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/line_monitor/log/line_log.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Records no frames until `print_frames`, `keep_in` or `tell` is called.
class LineRecord final : private Station {
 public:
  using Print = LineLog::Print;

  /// `line` has started up, and must outlive this object. If frames are recorded or `end_at` is called, this
  /// object must live as long as its wires are used. `name`: in a JSON log and in the capture.
  LineRecord(Line& line, std::string name, LogFormat format, const Print& print);

  /// Printed even if frames are not. Nothing after `end_at`.
  void note(const std::string& text);
  /// What happens to the line and its modules: printed only if frames are.
  void event(const std::string& text);
  void print_frames();
  /// `capture` must outlive this object. `began`: the line's time 0, since 1970-01-01 00:00:00 UTC.
  void keep_in(Capture& capture, VirtualTime began);
  /// After a recorded frame, notes why no module replies, if known (`hint_for`); each text once.
  void give_hints() { gives_hints_ = true; }
  /// `take` gets each frame when it has ended, `note` each note.
  void tell(FrameWatch::Take take, LineLog::Note note);
  /// In the line's time, which must not have reached it. The line may run beyond `end`, because the wall
  /// clock is read only at some moments; what happens then is not recorded.
  void end_at(VirtualTime end);
  /// Null: no frames are recorded.
  FrameWatch* frames() { return listens_ ? &frames_ : nullptr; }
  /// Records the frames that are still in progress.
  void finish() { frames_.finish(); }

 private:
  // At the time of `end_at`.
  void run() override;

  void write(const std::string& text, bool prints);
  void hear_modules();
  void listen(FrameWatch::Take take);
  void take(const Frame& frame);

  Line& line_;
  std::string name_;
  std::unique_ptr<LineLog> log_;
  FrameWatch frames_{[this] { return line_.master().mode(); }};
  LineLog::Note also_note_;
  std::vector<FrameWatch::Take> takers_;
  bool gives_hints_ = false;
  std::set<std::string> hints_;
  bool prints_ = false;
  bool listens_ = false;
  bool over_ = false;
};

}  // namespace ex9000::sim
