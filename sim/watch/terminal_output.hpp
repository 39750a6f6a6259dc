// The terminal on standard output.
#pragma once

#include <string>

#include "sim/watch/terminal.hpp"

namespace ex9000::sim {

/// Whether the character map that this names, as `UTF-8` or `en_US.utf8`, is UTF-8.
bool names_utf8(const std::string& locale);

/// What it has not taken yet waits here: a terminal that is stopped, as by Ctrl-S, stops nothing else. It is
/// opened once more for that, since the shell has the same opening of it.
class TerminalOutput final : public Terminal {
 public:
  TerminalOutput();
  /// What has not been taken by now is lost.
  ~TerminalOutput() override;
  TerminalOutput(const TerminalOutput&) = delete;
  TerminalOutput& operator=(const TerminalOutput&) = delete;

  /// False: standard output is no terminal, or one without a cursor to place. Nothing else may be called
  /// then.
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }

  // --- Terminal ---
  [[nodiscard]] Screen screen() const override;
  /// Blocks where a megabyte waits already.
  void write(const std::string& text) override;
  bool keeps_up() override;

 private:
  void flush();

  int fd_ = -1;
  std::string waiting_;
};

}  // namespace ex9000::sim
