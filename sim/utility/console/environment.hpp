// What the program uses of the computer.
#pragma once

#include <functional>
#include <memory>
#include <ostream>

#include "sim/utility/connection/port.hpp"

namespace ex9000::utility {

struct Environment {
  std::function<std::unique_ptr<Connection>(const Port& port, hal::SerialMode mode)> open;
  std::ostream& output;
  std::ostream& error;
  bool output_is_terminal = false;
  bool error_is_terminal = false;
};

}  // namespace ex9000::utility
