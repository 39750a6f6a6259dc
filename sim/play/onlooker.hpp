// Interface for code that observes a play, for example to log it.
#pragma once

#include <string>

#include "sim/line/line.hpp"

namespace ex9000::play {

class Onlooker {
 public:
  Onlooker() = default;
  Onlooker(const Onlooker&) = delete;
  Onlooker& operator=(const Onlooker&) = delete;
  virtual ~Onlooker() = default;

  /// A file, or the part of it for one model, is about to be played.
  virtual void begins(const std::string& what) = 0;
  /// A line of the play has started up. It lives until `ends`. `name` may be empty if there is only one line.
  /// Returns the receiver of messages about its faults.
  virtual sim::Faults::Notice joins(sim::Line& line, const std::string& name) = 0;
  /// All events on its lines up to `now` have been observed.
  virtual void reached(sim::VirtualTime now) = 0;
  virtual void ends() = 0;
};

}  // namespace ex9000::play
