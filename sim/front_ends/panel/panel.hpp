// Shows the face of every module and the traffic of the lines to any number of viewers.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/front_ends/control_socket/control.hpp"
#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/line_monitor/log/banner.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Carries messages between the panel and one open page.
class PanelViewer {
 public:
  PanelViewer() = default;
  PanelViewer(const PanelViewer&) = delete;
  PanelViewer& operator=(const PanelViewer&) = delete;
  virtual ~PanelViewer() = default;

  /// Carries out a request of the page; a later call of `next` returns the reply. A request with a command
  /// may also contain a second command that undoes the first one. If the first command succeeds, the page
  /// holds the action of this command active until the page sends the second command, or until `leave`.
  /// Returns false if `text` is not a valid request, or if the page would hold too many actions active.
  virtual bool ask(const std::string& text) = 0;
  /// Returns the next message for the page. The message contains all new replies, the new recent traffic, and
  /// the new changes that Panel::look has captured. The first message also describes the lines and their
  /// modules. Returns an empty text if there is nothing new and the last message is less than 1 s old.
  virtual std::string next() = 0;
  /// Call this when the page has disconnected: carries out the second command of each active action. Not the
  /// destructor does this, because a command advances a line, whose log or capture may fail; throws what the
  /// command throws. At the end of the program, destroy this object without this call.
  virtual void leave() = 0;
};

/// Viewers affect the lines only by the commands and requests that their pages send. Without viewers, the
/// panel only stores the last frames and notes of each line.
class Panel {
 public:
  using CarryOut = std::function<Control::Reply(const std::string& command)>;

  /// Sends a request on the line at position `line`, from 0.
  using Ask = std::function<void(std::size_t line, RequestQueue::Request request)>;

  using WallClock = std::function<std::chrono::steady_clock::time_point()>;

  /// `speed` is the ratio of the lines' time to the wall clock. `wall_clock` is the clock for the messages
  /// that pages get even if nothing has changed.
  Panel(CarryOut carry_out, Ask ask, double speed, WallClock wall_clock = std::chrono::steady_clock::now);
  ~Panel();
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Adds a line. Call this before the first viewer connects. `line` must outlive this object; `present`
  /// returns the line's time.
  void add_line(const LineSummary& summary, const Line& line, std::function<VirtualTime()> present);
  /// Adds a frame of the line at position `line`, from 0.
  void hear(std::size_t line, const Frame& frame);
  void note(std::size_t line, VirtualTime now, const std::string& text);

  /// Captures the present state for all viewers.
  void look();
  /// Returns the viewer for a page that has connected. This object must outlive the viewer.
  std::unique_ptr<PanelViewer> viewer();

 private:
  struct Tracked;
  struct Watched;
  struct Module;
  class Viewer;

  CarryOut carry_out_;
  Ask ask_;
  const double speed_;
  WallClock wall_clock_;
  const std::string run_;  ///< distinguishes this run of the program from other runs
  std::vector<Watched> lines_;
  std::uint64_t looks_ = 0;
};

}  // namespace ex9000::sim
