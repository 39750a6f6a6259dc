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

/// All ports get what the master's end of the line receives, and a rate that a master sets at a port becomes
/// the line's. Pacer or SteppedLine puts what masters send on the line.
class LinePorts final : private WireObserver {
 public:
  using All = std::vector<std::unique_ptr<Port>>;
  using Notice = std::function<void(const std::string&)>;

  /// This object and all arguments must live as long as the wires of `line` are used. `notice` gets one line
  /// for each module that cannot receive because of its rate or format, and for bytes that a port drops.
  LinePorts(Line& line, const All& ports, Notice notice);

  /// Each byte that the master's end has received.
  void hear(std::uint8_t byte) { heard_.push_back(byte); }
  /// A station other than the master has stopped sending since the last `hand_out`.
  [[nodiscard]] bool reply_is_complete() const { return stopped_sending_; }
  /// Sends the stored bytes to all ports and, if `reply_is_complete()`, tells them so (Port::sent). Does not
  /// block: a port without room drops bytes, and a notice reports the first of consecutive drops.
  void hand_out();
  /// Sets the line to the port's rate, if it has one, and reports mismatches.
  void take_rate(const Port& port);
  /// Bytes written to each port so far, with dropped ones.
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  /// Reports each module that listens but cannot receive at the line's rate or format; each mismatch once.
  void report_mismatches();

  /// Ports that have stopped because Arrivals has returned false continue.
  void resume();
  /// A port still waits for its first master before line time may begin.
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
