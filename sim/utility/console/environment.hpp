// What the program uses of the computer.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>

#include "sim/utility/connection/port.hpp"

namespace ex9000::utility {

/// Prints a question, and returns what the person enters; nullopt: the input has ended.
using AskPerson = std::function<std::optional<std::string>(const std::string& question)>;

struct Environment {
  std::function<std::unique_ptr<Connection>(const Port& port, hal::SerialMode mode)> open;
  std::ostream& output;
  std::ostream& error;
  /// Throws std::runtime_error if what has been written could not be: the disk is full, or a pipe is closed.
  void check_output() const {
    if (!output) {
      throw std::runtime_error("standard output: cannot be written; name another file or pipe");
    }
  }

  bool output_is_terminal = false;
  bool error_is_terminal = false;
  AskPerson ask_person = nullptr;  ///< null: nobody is there
};

}  // namespace ex9000::utility
