// What is written down of a line: its log and its capture.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "sim/bus_log.hpp"
#include "sim/capture/capture.hpp"
#include "sim/frame_watch.hpp"
#include "sim/line.hpp"
#include "sim/setup.hpp"

namespace ex9000::sim {

/// Nothing, until it is told what. Not behind `begin`.
class LineRecord final : private Station {
 public:
  using Print = BusLog::Print;

  /// Of a line that has come up and lives as long as this, and is called `name`. `print` gets the lines of
  /// its log.
  LineRecord(Line& line, std::string name, LogFormat format, const Print& print);

  /// Something that is said about the line now; it is printed whether frames are or not.
  void note(const std::string& text);
  /// Frames are printed.
  void print_frames();
  /// And kept in `capture`, which lives as long as this. `began`: what the wall clock, since 1970-01-01
  /// 00:00:00 UTC, is taken to have shown at the line's time 0.
  void keep_in(Capture& capture, VirtualTime began);
  /// And whoever looks on gets every frame when it is over, and what is said about the line.
  void tell(FrameWatch::Take take, BusLog::Note note);
  /// What happens later than `end`, by the line's time, is not written down, however far the line runs: that
  /// is up to when the host's clock is looked at.
  void end_at(VirtualTime end);
  /// From now on the line is listened to, if anybody wants that.
  void begin();

  /// What is to be told when a frame is due; null: nobody wants any. Behind `begin`.
  FrameWatch* frames() { return wanted_ ? &frames_ : nullptr; }
  /// Writes down what was still under way.
  void finish() { frames_.finish(); }

 private:
  // --- Station: one that but looks at the clock ---
  [[nodiscard]] VirtualTime next() const override { return end_; }
  void run() override;
  [[nodiscard]] std::uint32_t baud() const override { return 0; }
  void receive(std::uint8_t /*byte*/, ByteStatus /*status*/) override {}

  Line& line_;
  std::string name_;
  std::unique_ptr<BusLog> log_;
  FrameWatch frames_{[this] { return line_.master().baud(); }};
  BusLog::Note also_note_;
  bool wanted_ = false;
  VirtualTime end_ = kNever;  ///< as long as it is to come
  bool over_ = false;
};

}  // namespace ex9000::sim
