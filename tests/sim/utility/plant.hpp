// Simulated modules on a line in virtual time, and the program ex9000 as the master of this line.
#pragma once

#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "sim/app/play/line_target.hpp"
#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

class Plant {
 public:
  /// `modules`: as on the command line of ex9000-sim.
  explicit Plant(const std::vector<std::string>& modules);

  /// Runs `ex9000 WORDS` and returns the exit status. Any PORT is this line.
  int run(const std::vector<std::string>& words);
  /// Of the last run.
  [[nodiscard]] std::string output() const { return output_.str(); }
  [[nodiscard]] std::string error() const { return error_.str(); }

  /// An action of the control socket, for example `1 power off`.
  void act(const std::string& action) { target_.act(sim::words_of(action)); }
  /// Until a module that has been started or reset is ready.
  void wait() { target_.listen(std::chrono::milliseconds(200)); }
  [[nodiscard]] sim::VirtualTime now() { return target_.now(); }
  /// Gets each frame before it is sent; false: it is lost.
  std::function<bool(const Data& frame)> sends = [](const Data& /*frame*/) { return true; };
  bool echoes = false;  ///< the adapter receives what it sends
  /// Frames that a run has sent, also lost ones.
  std::vector<Data> sent;

 private:
  class Line;

  static sim::Setup setup_of(const std::vector<std::string>& modules);

  play::LineTarget target_;
  std::ostringstream output_;
  std::ostringstream error_;
};

}  // namespace ex9000::utility
