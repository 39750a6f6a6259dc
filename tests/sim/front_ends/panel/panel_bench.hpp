#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "sim/front_ends/control_socket/control.hpp"
#include "sim/front_ends/panel/face.hpp"
#include "sim/front_ends/panel/messages.hpp"
#include "sim/front_ends/panel/panel.hpp"
#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {

/// A line with one module, and a panel with one page that shows this line.
class PanelBench : public ModuleBench {
 public:
  explicit PanelBench(const std::string& spec)
      : ModuleBench(spec),
        control_({{"hall", line()}}),
        panel_([this](const std::string& command) { return control_.carry_out(command); },
               [this](std::size_t /*line*/, RequestQueue::Request request) {
                 line().requests().ask(std::move(request));
               },
               1, [this] { return wall_clock_; }) {
    LineSummary summary;
    summary.name = "hall";
    summary.ports.push_back({"tcp", "127.0.0.1:5020", ""});
    panel_.add_line(panel_line(summary, line(), [this] { return now(); }));
    frames_.add_receiver([this](const Frame& frame) { panel_.hear(0, frame); });
    line().wires().observe(frames_);
    viewer_ = panel_.viewer();
  }

  /// Updates the panel and returns the next message for the page; null if there is none.
  Message look() { return look(*viewer_); }
  Message look(PanelViewer& viewer) {
    panel_.look();
    const std::string text = viewer.next();
    return text.empty() ? Message() : Message::parse(text);
  }
  /// Ends the frames that are in progress.
  void end_frames() { frames_.finish(); }
  PanelViewer& viewer() { return *viewer_; }
  Panel& panel() { return panel_; }
  /// Advances the wall clock, which does not advance otherwise.
  void pass_wall_time(std::chrono::nanoseconds time) { wall_clock_ += time; }

 private:
  Control control_;
  std::chrono::steady_clock::time_point wall_clock_{std::chrono::hours(1)};
  Panel panel_;
  FrameWatch frames_{[this] { return line().master().mode(); }};
  std::unique_ptr<PanelViewer> viewer_;
};

}  // namespace ex9000::sim
