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

/// Stores the bytes that arrive at the line's ports and the requests that arrive at its Modbus TCP server,
/// until `put_on_line`. No function reads the wall clock or blocks.
class SteppedLine final : private Arrivals {
 public:
  using Arrived = std::function<void()>;

  /// If at least this many bytes are stored after a port has delivered bytes, the port delivers no more bytes
  /// of the same master, and a gateway no more bytes of any client, until `put_on_line`.
  static constexpr std::size_t kMostBytes = 65'536;

  /// `frames` may be null. All arguments must outlive this object.
  SteppedLine(Line& line, LinePorts& ports, FrameWatch* frames)
      : line_(line), ports_(ports), frames_(frames) {}

  /// Accepts masters. `arrived` is called whenever bytes have arrived at a port.
  void start(Arrived arrived);

  /// Returns the number of bytes that have arrived since the last `put_on_line`.
  [[nodiscard]] std::size_t waiting() const { return waiting_; }
  /// Reads what is available at the ports, within the limit of `kMostBytes`.
  void read_ports();
  /// Adds the stored bytes to the end of the master's queue; the master sends them without a gap. Adds the
  /// stored requests of a gateway to the line's queue. Lets ports that have stopped at `kMostBytes` deliver
  /// again.
  void put_on_line();

  [[nodiscard]] VirtualTime now() const { return line_.clock().virtual_now(); }
  /// Returns the time of the next event; kNever if no event occurs without an action from outside.
  [[nodiscard]] VirtualTime next() const { return line_.wires().next(); }
  /// Processes all events up to and including `until`. Calls `hand_out` if a reply has become complete.
  void run_until(VirtualTime until);
  /// See Line::pending.
  [[nodiscard]] bool pending() const { return line_.pending(); }
  /// See LinePorts::hand_out.
  void hand_out() { ports_.hand_out(); }

 private:
  /// Processes bytes that have arrived together: adds them to the master's queue, or adds the requests in
  /// them to the line's queue.
  using Put = std::function<void()>;

  bool store(std::size_t size, Put put);
  // --- Arrivals ---
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
