// Every module's face, and what is said on the lines, for any number of people who look on.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sim/control/control.hpp"
#include "sim/frame_watch.hpp"
#include "sim/greeting.hpp"
#include "sim/line.hpp"
#include "sim/panel/panel_server.hpp"

namespace ex9000::sim {

/// Looking changes nothing on a line, and costs nothing where nobody does but the last frames' memory.
class Panel final : public PanelSource {
 public:
  using CarryOut = std::function<Control::Reply(const std::string& command)>;

  using WallClock = std::function<std::chrono::steady_clock::time_point()>;

  /// `speed`: of the lines' time to the wall clock's. `wall_clock` says when a page that has heard nothing
  /// needs a sign of life.
  Panel(CarryOut carry_out, double speed, WallClock wall_clock = std::chrono::steady_clock::now);
  ~Panel() override;
  Panel(const Panel&) = delete;
  Panel& operator=(const Panel&) = delete;

  /// Before anybody looks. `line` lives as long as this; `present` tells its time.
  void add_line(const LineIntroduced& introduced, const Line& line, std::function<VirtualTime()> present);
  /// What is said on the line of this position, from 0.
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
  WallClock wall_clock_;
  std::unique_ptr<State> state_;
};

}  // namespace ex9000::sim
