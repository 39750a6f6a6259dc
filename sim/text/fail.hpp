// Errors in user input: one line, `WHERE: what is wrong; what would be right`.
#pragma once

#include <stdexcept>
#include <string>

namespace ex9000::sim {

[[noreturn]] inline void fail(const std::string& what) { throw std::invalid_argument(what); }

/// Runs `action` and adds the prefix `where` to the messages of its exceptions, for example `--pty ` or
/// `bus.json:4: lines[0].pty: `.
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
