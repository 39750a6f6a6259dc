// Shows how far a long task is: a bar in a terminal, else a line for each tenth.
#pragma once

#include <cstdint>
#include <string>

#include "sim/utility/console/environment.hpp"

namespace ex9000::utility {

class Progress {
 public:
  /// On standard error. `name`: of what the bar shows.
  Progress(Environment& environment, std::string name);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Ends the line of the bar.
  ~Progress();

  void show(std::uint64_t done, std::uint64_t of);
  /// Before other output to the terminal.
  void clear();

 private:
  Environment& environment_;
  std::string name_;
  int tenth_ = -1;
  bool shown_ = false;
};

}  // namespace ex9000::utility
