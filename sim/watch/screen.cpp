#include "sim/watch/screen.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

namespace ex9000::sim {

namespace {

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// The first of these that says something is the one that counts (POSIX.1-2017, XBD 8.2).
bool speaks_utf8() {
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    const std::string locale = environment(variable);
    if (!locale.empty()) {
      return locale.find("UTF-8") != std::string::npos || locale.find("utf8") != std::string::npos;
    }
  }
  return false;
}

}  // namespace

std::optional<Screen> screen_of_standard_output() {
  if (isatty(STDOUT_FILENO) == 0 || environment("TERM") == "dumb") {
    return std::nullopt;
  }
  Screen screen;
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row != 0 && size.ws_col != 0) {
    screen.rows = size.ws_row;
    screen.columns = size.ws_col;
  }
  screen.utf8 = speaks_utf8();
  return screen;
}

}  // namespace ex9000::sim
