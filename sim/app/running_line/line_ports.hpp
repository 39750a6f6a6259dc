// Connects the ports of a line to the master's end of the line.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/files_and_ports/ports/port.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Every port gets the bytes that the master's end of the line receives. If a master sets a rate at a port,
/// this rate becomes the line's rate. Pacer or SteppedLine puts the bytes and the requests of masters on the
/// line.
class LinePorts final : private WireObserver {
 public:
  using All = std::vector<std::unique_ptr<Port>>;
  using Notice = std::function<void(const std::string&)>;

  /// Observes the bus of `line`: this object and all arguments must live as long as that bus is used.
  /// `notice` receives a one-line message for each module that cannot receive because
  /// of its rate or format, and for bytes that a port drops.
  LinePorts(Line& line, const All& ports, Notice notice);

  /// Stores a byte that the master's end of the line has received. Call this for each such byte.
  void hear(std::uint8_t byte) { heard_.push_back(byte); }
  /// Returns whether a station other than the master has stopped sending since the last `hand_out`.
  [[nodiscard]] bool reply_is_complete() const { return stopped_sending_; }
  /// Calls `Port::send` of all ports with the bytes that `hear` has stored, and then discards these bytes. If
  /// `reply_is_complete()` is true at the time of this call, also calls `Port::sent` of all ports. Does not
  /// block: a port that has no room drops bytes. Reports the first of consecutive drops at a port with a
  /// notice.
  void hand_out();
  /// Sets the line to the rate of the port, if the port has one, and reports mismatches.
  void take_rate(const Port& port);
  /// Returns the number of bytes written to each port so far, including dropped bytes.
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  /// Reports each module that listens but cannot receive because its rate or format differs from that of the
  /// line. Reports a mismatch only once, unless the mismatch ends and begins again.
  void report_mismatches();

  /// Lets the ports continue if they have stopped because Arrivals has returned false.
  void resume();
  /// Whether a port still waits for its first master before line time may begin.
  [[nodiscard]] bool hold_line() const;

  [[nodiscard]] const All& all() const { return ports_; }

 private:
  void report_dropped(const Port& port, std::size_t bytes);
  void driver(std::size_t station, bool on, VirtualTime now) override;
  void byte(std::size_t /*station*/, std::uint8_t /*byte*/, SerialMode /*mode*/, bool /*collided*/,
            VirtualTime /*start*/, VirtualTime /*end*/) override {}

  Line& line_;
  const All& ports_;
  Notice notice_;
  using Mismatch = std::pair<SerialMode, SerialMode>;  ///< mode of the line, mode of a module
  std::vector<Mismatch> reported_;                     ///< one for each module; zeros: no mismatch
  bool mismatches_ = false;                            ///< `reported_` contains a mismatch
  std::vector<std::uint8_t> heard_;
  std::uint64_t sent_ = 0;
  std::vector<const Port*> full_;  ///< ports that dropped bytes at their last `send`
  bool stopped_sending_ = false;   ///< see reply_is_complete
};

}  // namespace ex9000::sim
