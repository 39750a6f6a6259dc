// Shows the face of every module and the traffic of the lines to any number of viewers.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "sim/front_ends/control/control.hpp"
#include "sim/front_ends/panel/panel_server.hpp"
#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/line_monitor/log/banner.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Viewers affect the lines only by the commands and requests that their pages send. Without viewers, the
/// panel only stores the last frames and notes of each line.
class Panel final : public PanelSource {
 public:
  using CarryOut = std::function<Control::Reply(const std::string& command)>;

  /// Sends a request on the line at position `line`, from 0. `request.done` must be called on the thread that
  /// uses this Panel.
  using Ask = std::function<void(std::size_t line, RequestQueue::Request request)>;

  using WallClock = std::function<std::chrono::steady_clock::time_point()>;

  /// `speed` is the ratio of the lines' time to the wall clock. `wall_clock` is the clock for the messages
  /// that pages get even if nothing has changed.
  Panel(CarryOut carry_out, Ask ask, double speed, WallClock wall_clock = std::chrono::steady_clock::now);
  ~Panel() override;
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Adds a line. Call this before the first viewer connects. `line` must outlive this object; `present`
  /// returns the line's time.
  void add_line(const LineSummary& summary, const Line& line, std::function<VirtualTime()> present);
  /// Adds a frame of the line at position `line`, from 0.
  void hear(std::size_t line, const Frame& frame);
  void note(std::size_t line, VirtualTime now, const std::string& text);

  // --- PanelSource ---
  void look() override;
  std::unique_ptr<PanelViewer> viewer() override;

 private:
  struct Watched;
  struct Module;
  struct State;
  class Viewer;

  CarryOut carry_out_;
  Ask ask_;
  WallClock wall_clock_;
  std::unique_ptr<State> state_;
};

}  // namespace ex9000::sim
