// A line whose time stands still until somebody moves it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "sim/frame_watch.hpp"
#include "sim/line.hpp"
#include "sim/runtime/line_ports.hpp"

namespace ex9000::sim {

/// Keeps the bytes that arrive at the line's ports until they are put on the line. Nothing here reads a
/// clock, and nothing blocks.
class SteppedLine {
 public:
  using Arrived = std::function<void()>;

  /// The most bytes that are kept; beyond that masters have to wait.
  static constexpr std::size_t kMostBytes = 65'536;

  /// `frames` may be null. All arguments live as long as this object.
  SteppedLine(Line& line, const LinePorts::All& ports, FrameWatch* frames, LinePorts::Notice notice);

  /// Lets masters in. `arrived` is called whenever bytes have arrived.
  void start(Arrived arrived);
  /// From the master's end of the line; for Line's constructor.
  void hear(std::uint8_t byte) { ports_.hear(byte); }

  /// How many bytes have arrived that are not on the line yet.
  [[nodiscard]] std::size_t waiting() const { return waiting_; }
  /// Reads everything that is there at the ports.
  void read_ports();
  /// Puts what has arrived on the line, without a gap, behind what the master still has to send.
  void put_on_line();

  [[nodiscard]] VirtualTime now() const { return line_.clock().virtual_now(); }
  /// When something happens next; kNever: only when somebody does something.
  [[nodiscard]] VirtualTime next() const { return line_.bus().next(); }
  /// Lets everything happen up to and including `until`.
  void run_until(VirtualTime until);
  /// A byte, a silence, a reply or a store is under way: see Line::pending.
  [[nodiscard]] bool pending() const { return line_.pending(); }
  /// See LinePorts::sent.
  [[nodiscard]] std::uint64_t sent() const { return ports_.sent(); }
  /// Writes to the ports what was heard and is not there yet.
  void hand_out() { ports_.hand_out(); }

 private:
  struct Chunk {
    const Port* port;
    std::vector<std::uint8_t> bytes;
  };

  bool receive(const Port& port, const std::uint8_t* bytes, std::size_t size);

  Line& line_;
  LinePorts ports_;
  FrameWatch* frames_;
  Arrived arrived_;
  std::vector<Chunk> chunks_;  ///< in the order of arrival
  std::size_t waiting_ = 0;    ///< bytes in them
  bool paused_ = false;        ///< a port has been told to wait
};

}  // namespace ex9000::sim
