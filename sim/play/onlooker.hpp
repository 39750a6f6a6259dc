// Somebody who looks on while something is played.
#pragma once

#include <string>

#include "sim/line.hpp"

namespace ex9000::play {

class Onlooker {
 public:
  Onlooker() = default;
  Onlooker(const Onlooker&) = delete;
  Onlooker& operator=(const Onlooker&) = delete;
  virtual ~Onlooker() = default;

  /// A file, or what it says of one model, is to be played.
  virtual void begins(const std::string& what) = 0;
  /// A line of it has come up, which lives until `ends`; `name` may be empty where there is but one. Who is
  /// to be told what goes wrong with it.
  virtual sim::Faults::Notice joins(sim::Line& line, const std::string& name) = 0;
  /// All that has happened on its lines until now has been seen.
  virtual void reached(sim::VirtualTime now) = 0;
  virtual void ends() = 0;
};

}  // namespace ex9000::play
