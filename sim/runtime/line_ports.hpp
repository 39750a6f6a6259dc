// A line's ports, between its master's end and real masters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/line.hpp"
#include "sim/ports/port.hpp"

namespace ex9000::sim {

/// What modules send goes to every port; the rate that a master sets at a port becomes the line's.
/// The same whatever moves the line's time.
class LinePorts final : private BusObserver {
 public:
  using All = std::vector<std::unique_ptr<Port>>;
  using Notice = std::function<void(const std::string&)>;

  /// All arguments live as long as the line's bus is used. `notice` gets one line of text, for people, for
  /// each module that listens at another rate than the line's, and for bytes that a port had no room for.
  LinePorts(Line& line, const All& ports, Notice notice);

  /// From the master's end of the line; for Line's constructor.
  void hear(std::uint8_t byte) { heard_.push_back(byte); }
  /// A module has stopped sending since the last `hand_out`.
  [[nodiscard]] bool reply_is_complete() const { return stopped_sending_; }
  /// Writes to all ports what was heard since the last call. Does not block: bytes that find no room are
  /// dropped, with a notice for the first of them.
  void hand_out();
  /// A port at which nobody has set a rate leaves the line's rate alone.
  void take_rate(const Port& port);
  /// Bytes that were written to the ports so far, or dropped there.
  [[nodiscard]] std::uint64_t sent() const { return sent_; }
  /// Reports each mismatch of rates once, until it is over.
  void report_mismatches();

  [[nodiscard]] const All& all() const { return ports_; }

 private:
  void report_dropped(const Port& port, std::size_t bytes);
  void driver(std::size_t station, bool on, VirtualTime now) override;
  void byte(std::size_t /*station*/, std::uint8_t /*byte*/, std::uint32_t /*baud*/, bool /*collided*/,
            VirtualTime /*start*/, VirtualTime /*end*/) override {}

  Line& line_;
  const All& ports_;
  Notice notice_;
  using Mismatch = std::pair<std::uint32_t, std::uint32_t>;  ///< rate of the line, rate of a module
  std::vector<Mismatch> reported_;                           ///< one for each module; zeros: none
  std::vector<std::uint8_t> heard_;
  std::uint64_t sent_ = 0;
  std::vector<const Port*> full_;  ///< those that dropped bytes last, which has been reported
  bool stopped_sending_ = false;   ///< a module, since `heard_` was handed out
};

}  // namespace ex9000::sim
