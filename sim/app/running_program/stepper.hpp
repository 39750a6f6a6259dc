// Carries out the command `advance`, which advances the time of lines in stepped time.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/app/running_line/stepped_line.hpp"
#include "sim/front_ends/control_socket/control.hpp"

namespace ex9000::sim {

/// Between commands, all lines have the same time. Events depend only on the commands and on the bytes that
/// arrive: if the same bytes arrive before the same commands, modules send the same replies at the same
/// virtual times.
class Stepper {
 public:
  using Answer = std::function<void(const Control::Reply&)>;

  /// Returns whether the program has been asked to end.
  using StopRequested = std::function<bool()>;

  /// The lines must outlive this object. When their time reaches `end`, the program ends. `end` is kNever if
  /// the run has no end. `stop_requested` is called repeatedly during an `advance` with many events.
  Stepper(std::vector<SteppedLine*> lines, VirtualTime end, StopRequested stop_requested);

  /// Returns whether the first word of `command` is `advance`.
  static bool is_advance(const std::string& command);
  /// Carries out `advance TIME [after N] [quiet]`, with the last two in either order, in these steps:
  /// - Counts the bytes that have arrived, except those that an earlier `advance` has put on a line. If there
  ///   are fewer than N, returns. The first call of `arrived` that finds at least N such bytes then carries
  ///   out the next steps.
  /// - Reads what is available at all ports and Modbus TCP servers, and puts it on their lines.
  /// - Advances the lines by TIME, but not beyond `end`. With `quiet`, stops earlier, as soon as nothing is
  ///   pending on any line.
  /// - Writes to the ports the bytes that modules and faults have sent, and calls `answer`.
  ///
  /// `answer` receives `ok NOW`, where NOW is the lines' time in seconds, or `error: ...`. If the command is
  /// wrong, it has no effect except the error. If the program is asked to end while time passes, time stops
  /// and `answer` receives an error. A later correct command replaces one that still waits for bytes; the
  /// `answer` of the replaced command receives an error.
  void advance(const std::string& command, Answer answer);
  /// Call this when bytes have arrived at a port or at a Modbus TCP server.
  void arrived();

 private:
  struct Request {
    VirtualTime time{};
    std::size_t after = 0;
    bool quiet = false;
  };
  struct Waiting {
    Request request;
    Answer answer;
  };

  static Request parse(const std::string& command);
  void read_ports();
  void carry_out(const Request& request, const Answer& answer);
  [[nodiscard]] std::size_t bytes_waiting() const;
  [[nodiscard]] bool pass(const Request& request);

  std::vector<SteppedLine*> lines_;
  VirtualTime end_;
  StopRequested stop_requested_;
  std::optional<Waiting> waiting_;
};

}  // namespace ex9000::sim
