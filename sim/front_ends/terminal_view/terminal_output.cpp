#include "sim/front_ends/terminal_view/terminal_output.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>
#include <utility>

namespace ex9000::sim {

namespace {

constexpr std::size_t kMostWaiting = 1 << 20;

std::string environment(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// Returns the value of the first of LC_ALL, LC_CTYPE and LANG that is not empty. This variable determines
/// the character encoding (POSIX.1-2017, XBD 8.2). Returns an empty string if all three are empty.
std::string locale() {
  for (const char* variable : {"LC_ALL", "LC_CTYPE", "LANG"}) {
    if (std::string value = environment(variable); !value.empty()) {
      return value;
    }
  }
  return "";
}

}  // namespace

bool names_utf8(const std::string& locale) {
  return strcasestr(locale.c_str(), "UTF-8") != nullptr || strcasestr(locale.c_str(), "UTF8") != nullptr;
}

TerminalOutput::TerminalOutput(int descriptor, GivesUp gives_up) : gives_up_(std::move(gives_up)) {
  if (isatty(descriptor) != 0 && environment("TERM") != "dumb") {
    const std::string terminal = "/proc/self/fd/" + std::to_string(descriptor);
    fd_ = FileDescriptor(open(terminal.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
  }
}

TerminalOutput::~TerminalOutput() { flush(); }

Screen TerminalOutput::screen() const {
  Screen screen;
  winsize size{};
  if (ioctl(fd_.get(), TIOCGWINSZ, &size) == 0 && size.ws_row != 0 && size.ws_col != 0) {
    screen.rows = size.ws_row;
    screen.columns = size.ws_col;
  }
  screen.utf8 = names_utf8(locale());
  return screen;
}

void TerminalOutput::write(const std::string& text) {
  waiting_ += text;
  flush();
  while (waiting_.size() > kMostWaiting && !gives_up_() && wait_for_room(fd_.get(), gives_up_)) {
    flush();
  }
}

bool TerminalOutput::keeps_up() {
  flush();
  return waiting_.empty();
}

/// Writes the waiting output until the terminal accepts no more. If a write fails, for example because the
/// terminal has disappeared, discards the waiting output.
void TerminalOutput::flush() {
  while (!waiting_.empty()) {
    const ssize_t taken = ::write(fd_.get(), waiting_.data(), waiting_.size());
    if (taken < 0 && errno == EINTR) {
      continue;
    }
    if (taken < 0 && errno != EAGAIN) {
      waiting_.clear();
    }
    if (taken <= 0) {
      return;
    }
    waiting_.erase(0, static_cast<std::size_t>(taken));
  }
}

}  // namespace ex9000::sim
