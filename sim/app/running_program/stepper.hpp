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

/// Between commands, all lines have the same time. If the same bytes arrive before the same commands, modules
/// send the same replies at the same virtual times.
class Stepper {
 public:
  using Answer = std::function<void(const Control::Reply&)>;

  /// Whether the program has been asked to end. Called repeatedly during a long `advance`.
  using StopRequested = std::function<bool()>;

  /// The lines must outlive this object. At `end` in their time (kNever: it has none), the program ends.
  Stepper(std::vector<SteppedLine*> lines, VirtualTime end, StopRequested stop_requested);

  static bool is_advance(const std::string& command);
  /// Carries out `advance TIME [after N] [quiet]`, the last two in either order:
  /// - If fewer than N bytes have arrived that no `advance` has put on a line, returns; the first `arrived`
  ///   that finds N goes on.
  /// - Reads what is available at all ports and Modbus TCP servers, and puts it on their lines.
  /// - Advances by TIME, but not beyond `end`; with `quiet`, only until nothing is pending on any line.
  /// - Writes what modules and faults have sent to the ports. `answer` gets `ok NOW`, the time in seconds.
  /// `answer` gets `error: ...` if the command is wrong and has no effect, if the program is asked to end
  /// while time passes, or if a later correct command replaces one that still waits for bytes.
  void advance(const std::string& command, Answer answer);
  /// When bytes have arrived at a port or at a Modbus TCP server.
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
