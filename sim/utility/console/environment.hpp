// What the program uses of the computer.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>

#include "sim/utility/connection/port.hpp"

namespace ex9000::utility {

/// Prints a question, and returns what the person enters; nullopt: the input has ended.
using AskPerson = std::function<std::optional<std::string>(const std::string& question)>;

struct Environment {
  std::function<std::unique_ptr<Connection>(const Port& port, hal::SerialMode mode)> open;
  std::ostream& output;
  std::ostream& error;
  bool output_is_terminal = false;
  bool error_is_terminal = false;
  AskPerson ask_person = nullptr;  ///< null: nobody is there
};

}  // namespace ex9000::utility
