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
#include "sim/front_ends/panel/messages.hpp"
#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/line_monitor/log/banner.hpp"
#include "sim/virtual_line/line/request_queue.hpp"

namespace ex9000::sim {

/// Between the panel and one open page.
class PanelViewer {
 public:
  PanelViewer() = default;
  PanelViewer(const PanelViewer&) = delete;
  PanelViewer& operator=(const PanelViewer&) = delete;
  virtual ~PanelViewer() = default;

  /// A request of the page; a later `next` returns the reply. It may have a second command that undoes the
  /// first: if the first succeeds, the page holds its action active until it sends the second, or until
  /// `leave`. false: not a valid request, or too many active actions.
  virtual bool ask(const std::string& text) = 0;
  /// All new replies, traffic, and changes that Panel::look has captured; the first message also describes
  /// lines and modules. Empty: nothing is new, and the last message is less than 1 s old.
  virtual std::string next() = 0;
  /// When the page has disconnected: carries out the second command of each active action, and throws what
  /// that throws. Not the destructor, because a command advances a line, whose log or capture may fail. At
  /// the end of the program, destroy this object without this call.
  virtual void leave() = 0;
};

/// What the panel shows of a line.
struct PanelLine {
  LineSummary summary;
  std::vector<const Model*> models;  ///< of its modules
  std::function<VirtualTime()> present;
  /// The state of the module at a position, from 0, as parts that change independently (page/plate.js).
  std::function<Message(std::size_t module)> face;
  std::function<std::vector<Faults::Info>()> faults;
};

/// Viewers affect the lines only by the commands and requests of their pages. Without viewers, the panel only
/// stores the last frames and notes of each line.
class Panel {
 public:
  using CarryOut = std::function<Control::Reply(const std::string& command)>;

  /// On the line at the position `line`, from 0.
  using Ask = std::function<void(std::size_t line, RequestQueue::Request request)>;

  using WallClock = std::function<std::chrono::steady_clock::time_point()>;

  /// `carry_out`: null for real modules, to which only requests can be sent. `speed`: of line time to the
  /// wall clock. `wall_clock`: for messages while nothing changes.
  Panel(CarryOut carry_out, Ask ask, double speed, WallClock wall_clock = std::chrono::steady_clock::now);
  ~Panel();
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Before the first viewer. The functions of `line` must work as long as this object lives.
  void add_line(PanelLine line);
  /// `line`: the position, from 0.
  void hear(std::size_t line, const Frame& frame);
  void note(std::size_t line, VirtualTime now, const std::string& text);

  /// Captures the present state for all viewers.
  void look();
  /// For a page that has connected. This object must outlive the viewer.
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
