// Simulated modules on a line in virtual time, and the program ex9000 as the master of this line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "sim/app/play/line_target.hpp"
#include "tests/sim/utility/target_line.hpp"

namespace ex9000::utility {

class Plant {
 public:
  /// `modules`: as on the command line of ex9000-sim.
  explicit Plant(const std::vector<std::string>& modules);

  // See Program.
  int run(const std::vector<std::string>& words);
  [[nodiscard]] std::string output() const { return program_.output(); }
  [[nodiscard]] std::string error() const { return program_.error(); }
  Environment environment() { return program_.environment(); }
  /// Forgets what a run has written and sent.
  void clear();

  /// An action of the control socket, for example `1 power off`.
  std::string act(const std::string& action) { return target_.act(sim::words_of(action)); }
  /// In the default time, a module that has been started or reset gets ready.
  void wait(Time time = std::chrono::milliseconds(200)) { target_.listen(time); }
  /// The EEPROM of the first module.
  std::vector<std::uint8_t>& memory() { return target_.module().memory().contents(); }
  [[nodiscard]] sim::VirtualTime now() { return target_.now(); }
  /// Gets each frame before it is sent; false: it is lost.
  std::function<bool(const Data& frame)> sends = [](const Data& /*frame*/) { return true; };
  /// Replies to a frame in place of the modules, which do not get it; nullopt: they do.
  std::function<std::optional<Data>(const Data& frame)> replies;
  /// Of the reply to the last frame, gets each byte and its position, and changes it; nullopt: it is lost.
  std::function<std::optional<std::uint8_t>(std::size_t at, std::uint8_t byte)> hears;
  Time delay{0};        ///< of each byte from the line to the program
  bool echoes = false;  ///< the adapter receives what it sends
  /// Frames that a run has sent, also lost ones.
  std::vector<Data> sent;

 private:
  class Line;
  struct Modules : play::LineTarget {
    using play::LineTarget::LineTarget;
    using play::LineTarget::module;
  };

  static sim::Setup setup_of(const std::vector<std::string>& modules);

  Modules target_;
  std::size_t heard_ = 0;  ///< bytes since the last frame
  Program program_;
};

}  // namespace ex9000::utility
