// Shows the modules' faces in a terminal.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/front_ends/terminal_view/terminal.hpp"
#include "sim/line_monitor/module_view/face.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

/// Redraws the faces in place. If the output is not a terminal, prints a line for each change.
class Watch {
 public:
  /// Gets lines of text; the last one has no newline.
  using Print = std::function<void(const std::string& lines)>;

  /// If `terminal` is null, `print` gets the lines; otherwise `print` is not called. `terminal` must outlive
  /// this object.
  Watch(Terminal* terminal, Print print) : terminal_(terminal), print_(std::move(print)) {}

  /// Adds a line; call this before `look`. `line` must outlive this object, and `present` returns the time of
  /// the line. An empty name is not shown.
  void add_line(std::string name, const Line& line, std::function<VirtualTime()> present);
  /// Shows the changes since the last call. Does nothing while the terminal has not accepted all earlier
  /// output.
  void look();
  /// Prints lines of other output, above the faces if faces are drawn.
  void print(const std::string& lines);

 private:
  struct Watched {
    std::string name;
    const Line& line;
    std::function<VirtualTime()> present;
    std::vector<std::optional<Face>> faces;  ///< as last printed; nullopt: not printed yet
  };

  [[nodiscard]] std::vector<std::string> painting() const;
  [[nodiscard]] std::vector<std::vector<std::string>> all_faces() const;
  void print_changes();
  void put(const std::string& lines);

  Terminal* terminal_;
  Print print_;
  std::vector<Watched> lines_;
  Screen screen_;                     ///< as `look` last read it
  std::vector<std::string> painted_;  ///< the lines above the cursor; empty: no faces are drawn
};

}  // namespace ex9000::sim
