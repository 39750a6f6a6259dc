// The terminal on standard output, or on another descriptor.
#pragma once

#include <string>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/files/wait_for_room.hpp"
#include "sim/front_ends/terminal_view/terminal.hpp"

namespace ex9000::sim {

/// Returns whether the name of a locale or character map, for example `UTF-8` or `en_US.utf8`, means UTF-8.
bool names_utf8(const std::string& locale);

/// Stores up to 1 MiB of output that the terminal has not accepted yet. A terminal that is stopped by Ctrl-S
/// therefore does not block the program until this limit is exceeded. Opens the terminal a second time,
/// because the shell shares the file description of `descriptor`, and O_NONBLOCK there would also affect the
/// shell.
class TerminalOutput final : public Terminal {
 public:
  /// Opens the terminal of `descriptor`. Never closes `descriptor`.
  explicit TerminalOutput(
      int descriptor, GivesUp gives_up = [] { return false; });
  /// Writes as much output as the terminal accepts without blocking, and discards the rest.
  ~TerminalOutput() override;
  TerminalOutput(const TerminalOutput&) = delete;
  TerminalOutput& operator=(const TerminalOutput&) = delete;

  /// Returns false if the descriptor is not a terminal, if TERM is `dumb` (the cursor of such a terminal
  /// cannot be moved), or if the terminal could not be opened. In these cases no other function may be
  /// called.
  [[nodiscard]] bool is_open() const { return fd_.is_open(); }

  // --- Terminal ---
  [[nodiscard]] Screen screen() const override;
  /// Blocks while more than 1 MiB of output is waiting and `gives_up` returns false.
  void write(const std::string& text) override;
  bool keeps_up() override;

 private:
  void flush();

  FileDescriptor fd_;
  std::string waiting_;
  GivesUp gives_up_;
};

}  // namespace ex9000::sim
