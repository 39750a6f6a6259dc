// The program ex9000 as the master of the module of a target.
#pragma once

#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "sim/app/play/target.hpp"
#include "sim/utility/console/environment.hpp"
#include "sim/utility/verify/rig.hpp"

namespace ex9000::utility {

class TargetLine : public Connection {
 public:
  /// `now`: the time of the target.
  TargetLine(play::Target& target, hal::SerialMode mode, std::function<Time()> now);

  void set_mode(hal::SerialMode mode) final;
  void send(const Data& bytes) override { target_.send(bytes); }
  Data receive(Time patience) override;
  Time now() final { return now_(); }

 private:
  play::Target& target_;
  std::function<Time()> now_;
};

/// Looks at the LED for as long as the target needs to see it flash, so no step after `led` may be timed.
class TargetRig final : public Rig {
 public:
  explicit TargetRig(play::Target& target) : target_(target) {}

  std::string ask(const std::string& request) override;

 private:
  play::Target& target_;
};

/// Any PORT is the same line.
class Program {
 public:
  using Open = std::function<std::unique_ptr<Connection>(hal::SerialMode mode)>;

  explicit Program(Open open) : open_(std::move(open)) {}

  /// Runs `ex9000 WORDS` and returns the exit status.
  int run(const std::vector<std::string>& words);
  /// Of the last run.
  [[nodiscard]] std::string output() const { return output_.str(); }
  [[nodiscard]] std::string error() const { return error_.str(); }

  /// For code below the program; writes to `output` and `error`.
  Environment environment();
  /// Forgets what a run has written.
  void clear();

 private:
  Open open_;
  std::ostringstream output_;
  std::ostringstream error_;
};

}  // namespace ex9000::utility
