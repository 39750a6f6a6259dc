// How sim/ reports errors: std::invalid_argument for wrong input of the user, std::runtime_error for what is
// not available or breaks. The message is one line: where, what is wrong and, mostly, what would be right.
// Functions that parse or open something throw like this; comments name only what differs.
#pragma once

#include <stdexcept>
#include <string>

namespace ex9000::sim {

[[noreturn]] inline void fail(const std::string& what) { throw std::invalid_argument(what); }

/// An action that is right, but not possible in the present state of a line or a module.
struct NotNow : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// An error that may be over at the next start with the same configuration: a port or file that another
/// program uses, an address or a device that is not there yet.
[[noreturn]] inline void unavailable(const std::string& what) { throw std::runtime_error(what); }

/// Puts `where`, for example `--pty: `, before the message of an error in `action`.
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
