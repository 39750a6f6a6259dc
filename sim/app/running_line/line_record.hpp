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

  /// Records a line that has started up. `line` must outlive this object. If frames are recorded or `end_at`
  /// is called, this object must also live as long as the bus of `line` is used. `name` is the name of the
  /// line in a JSON log and in the capture. `print` receives the lines of the log.
  LineRecord(Line& line, std::string name, LogFormat format, const Print& print);

  /// Writes a note to the log, with the time of the line's clock. Notes are printed even if frames are not.
  /// Does nothing after the end of the log, see `end_at`.
  void note(const std::string& text);
  /// The same for what happens to the line and its modules: printed only if frames are.
  void event(const std::string& text);
  void print_frames();
  /// Starts to write frames to `capture`, which must outlive this object. `began` is the timestamp of time 0
  /// of the line in the capture, since 1970-01-01 00:00:00 UTC.
  void keep_in(Capture& capture, VirtualTime began);
  /// From now on, a note follows each recorded frame to which no module replies, if the reason is known: see
  /// `hint_for`. Each text is noted once.
  void give_hints() { gives_hints_ = true; }
  /// Starts to call `take` with each frame when the frame has ended, and `note` with each note.
  void tell(FrameWatch::Take take, LineLog::Note note);
  /// Ends the log and the capture at `end` in the line's time. The line may run beyond `end`, because the
  /// program reads the wall clock only at some moments. The log and the capture omit everything that happens
  /// after `end`. Call this before the line's time reaches `end`.
  void end_at(VirtualTime end);
  /// Returns the collector of the frames; null if no frames are recorded.
  FrameWatch* frames() { return listens_ ? &frames_ : nullptr; }
  /// Records the frames that are still in progress.
  void finish() { frames_.finish(); }

 private:
  // --- Station: called at the time that `end_at` sets ---
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
