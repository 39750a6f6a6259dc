// Errors in user input, and resources that are not available. A message has one line: where the error is,
// what is wrong and, in most cases, what would be right.
#pragma once

#include <stdexcept>
#include <string>

namespace ex9000::sim {

[[noreturn]] inline void fail(const std::string& what) { throw std::invalid_argument(what); }

/// An action that is right, but not possible in the present state of a line or a module.
struct NotNow : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Throws an error that may be over at the next start of the program, although nothing in its configuration
/// has changed: a port or a file that another program uses, an address or a device that is not there yet.
[[noreturn]] inline void unavailable(const std::string& what) { throw std::runtime_error(what); }

/// Runs `action` and returns its result. Adds the prefix `where` to the message of a std::invalid_argument or
/// std::runtime_error that `action` throws. The prefix is, for example, `--pty: `.
template <class Action>
decltype(auto) with_place(const std::string& where, Action action) {
  try {
    return action();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(where + error.what());
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(where + error.what());
  }
}

}  // namespace ex9000::sim
