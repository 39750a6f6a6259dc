// A line in stepped time: only the command `advance` advances its clock.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "sim/app/running_line/line_ports.hpp"
#include "sim/line_monitor/frames/frame_watch.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Stores what arrives at the line's ports until `put_on_line`. Never reads the wall clock or blocks.
class SteppedLine final : private Arrivals {
 public:
  using Arrived = std::function<void()>;

  /// With so many bytes, a port delivers no more of this master, a gateway no more at all, until
  /// `put_on_line`.
  static constexpr std::size_t kMostBytes = 65'536;

  /// `frames` may be null. All arguments must outlive this object.
  SteppedLine(Line& line, LinePorts& ports, FrameWatch* frames)
      : line_(line), ports_(ports), frames_(frames) {}

  /// Accepts masters. `arrived`: whenever bytes have arrived at a port.
  void start(Arrived arrived);

  /// Bytes since the last `put_on_line`.
  [[nodiscard]] std::size_t waiting() const { return waiting_; }
  /// Reads what is available, within the limit of `kMostBytes`.
  void read_ports();
  /// Puts the bytes into the master's queue, which sends them without a gap, and requests into the line's.
  /// Ports that have stopped at `kMostBytes` deliver again.
  void put_on_line();

  [[nodiscard]] VirtualTime now() const { return line_.clock().virtual_now(); }
  /// kNever: no event occurs without an action from outside.
  [[nodiscard]] VirtualTime next() const { return line_.wires().next(); }
  /// Up to and including `until`. Calls `hand_out` if a reply has become complete.
  void run_until(VirtualTime until);
  [[nodiscard]] bool pending() const { return line_.pending(); }
  void hand_out() { ports_.hand_out(); }

 private:
  /// Bytes that have arrived together, or the requests in them.
  using Put = std::function<void()>;

  bool store(std::size_t size, Put put);
  bool bytes(const Port& port, Bytes bytes, const Port::Positions& damaged, Port::Sender sender) override;
  bool requests(std::size_t size, Put process) override { return store(size, std::move(process)); }

  /// Returns whether a port waits for `resume`.
  [[nodiscard]] bool full() const { return waiting_ >= kMostBytes; }

  Line& line_;
  LinePorts& ports_;
  FrameWatch* frames_;
  Arrived arrived_;
  std::vector<Put> arrivals_;  ///< in the order of arrival
  std::size_t waiting_ = 0;    ///< number of bytes in `arrivals_`
};

}  // namespace ex9000::sim
