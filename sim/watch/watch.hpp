// The modules' faces in a terminal.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/face/face.hpp"
#include "sim/line.hpp"
#include "sim/watch/terminal.hpp"

namespace ex9000::sim {

/// Repaints them in place, or prints a line for each change where the output is no terminal.
class Watch {
 public:
  /// Takes lines, without the last one's end.
  using Print = std::function<void(const std::string& lines)>;

  /// Null: there is no terminal, and `print` takes lines. It lives as long as this.
  Watch(Terminal* terminal, Print print) : terminal_(terminal), print_(std::move(print)) {}

  /// Before `look`. `line` lives as long as this, and `present` tells its time; an empty name is not shown.
  void add_line(std::string name, const Line& line, std::function<VirtualTime()> present);
  /// Shows what has changed since the last look; not on a terminal that does not keep up.
  void look();
  /// Prints lines of something else: above the faces, which stay below all.
  void print(const std::string& lines);

 private:
  struct Watched {
    std::string name;
    const Line& line;
    std::function<VirtualTime()> present;
    std::vector<std::optional<Face>> faces;  ///< as last told of; none: not yet
  };

  [[nodiscard]] std::vector<std::string> painting() const;
  [[nodiscard]] std::vector<std::vector<std::string>> all_faces() const;
  void tell_changes();
  void put(const std::string& lines);

  Terminal* terminal_;
  Print print_;
  std::vector<Watched> lines_;
  Screen screen_;                     ///< as it was when it was painted
  std::vector<std::string> painted_;  ///< what stands above the cursor; nothing: no faces
};

}  // namespace ex9000::sim
