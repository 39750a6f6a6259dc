// Carries out the command `advance`, which advances the time of lines in stepped time.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/app/running_line/stepped_line.hpp"
#include "sim/front_ends/control/control.hpp"

namespace ex9000::sim {

/// All lines have the same time. Events depend only on the commands and on the bytes that arrive: the same
/// commands produce the same bytes at the same virtual times.
class Stepper {
 public:
  using Answer = std::function<void(const Control::Reply&)>;

  /// Returns whether the program has been asked to end.
  using StopRequested = std::function<bool()>;

  /// `lines` must outlive this object. When their time reaches `end`, the program ends; kNever: no end.
  /// `stop_requested` is called regularly while time passes.
  Stepper(std::vector<SteppedLine*> lines, VirtualTime end, StopRequested stop_requested);

  /// Returns whether `command` is an `advance` command.
  static bool is_advance(const std::string& command);
  /// Carries out `advance TIME [after N] [quiet]`. Does not wait for bytes: calls `answer`, during this call
  /// or later, as soon as all of these are true:
  /// - N bytes have arrived at the ports that no earlier `advance` has put on a line. Everything that is
  ///   available has been read and put on its line.
  /// - TIME has passed, or the lines have reached `end`. With `quiet`, it is also sufficient that nothing is
  ///   pending on any line.
  /// - Every reply has been written to its port.
  ///
  /// `answer` receives `ok NOW`, the lines' time in seconds, or `error: ...`. If the command is wrong,
  /// nothing changes. If the program is asked to end while time passes, time stops and `answer` receives an
  /// error. A later call replaces a call that still waits for bytes; the replaced call receives an error.
  void advance(const std::string& command, Answer answer);
  /// Call this when bytes have arrived at a port.
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
