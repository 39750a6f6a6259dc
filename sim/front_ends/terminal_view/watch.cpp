#include "sim/front_ends/terminal_view/watch.hpp"

#include "sim/front_ends/terminal_view/face_text.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

// Control sequences of ECMA-48: CUP, cursor position (8.3.21); CPL, cursor preceding line (8.3.13); ED, erase
// in page (8.3.39).
constexpr const char* kEraseAll = "\x1b[H\x1b[J";
std::string back_over(std::size_t lines) { return "\x1b[" + std::to_string(lines) + "F\x1b[J"; }

/// Cuts `line` after `columns` characters, because a wrapped line would move the cursor to a wrong position.
/// Counts only the first byte of each UTF-8 character.
std::string shortened(const std::string& line, std::size_t columns) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool begins = (static_cast<unsigned char>(line[i]) & 0xC0U) != 0x80U;
    if (begins && seen++ == columns) {
      return line.substr(0, i);
    }
  }
  return line;
}

}  // namespace

void Watch::add_line(std::string name, const Line& line, std::function<VirtualTime()> present) {
  lines_.push_back(
      {std::move(name), line, std::move(present), std::vector<std::optional<Face>>(line.size())});
}

void Watch::look() {
  if (terminal_ == nullptr) {
    print_changes();
    return;
  }
  if (!terminal_->keeps_up()) {
    return;
  }
  const Screen screen = terminal_->screen();
  // After a change of the screen's size, the positions of the old lines are unknown.
  const bool moved = !painted_.empty() && !(screen == screen_);
  screen_ = screen;
  const std::vector<std::string> faces = painting();
  if (moved || faces != painted_) {
    put((moved              ? std::string(kEraseAll)
         : painted_.empty() ? std::string()
                            : back_over(painted_.size())) +
        joined(faces, "\n"));
    painted_ = faces;
  }
}

void Watch::print(const std::string& lines) {
  put(painted_.empty() ? lines : back_over(painted_.size()) + lines + "\n" + joined(painted_, "\n"));
}

/// Passes all lines to the terminal in one call, because the terminal could show incomplete output between
/// two calls. Without a terminal, passes the lines to `print_`.
void Watch::put(const std::string& lines) {
  if (terminal_ == nullptr) {
    print_(lines);
  } else {
    terminal_->write(lines + "\n");
  }
}

/// Returns the lines of as many modules as fit on the screen. Keeps one row free for the cursor. If not
/// all modules fit, adds a line with the number of hidden modules.
std::vector<std::string> Watch::painting() const {
  const std::vector<std::vector<std::string>> faces = all_faces();
  std::size_t rows = 0;
  for (const auto& face : faces) {
    rows += face.size();
  }
  std::size_t shown = faces.size();
  while (shown != 0 && rows + (shown == faces.size() ? 1 : 2) > screen_.rows) {
    rows -= faces[--shown].size();
  }
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < shown; ++i) {
    lines.insert(lines.end(), faces[i].begin(), faces[i].end());
  }
  if (shown != faces.size()) {
    const std::size_t left_out = faces.size() - shown;
    lines.push_back(std::to_string(left_out) + (left_out == 1 ? " more module is" : " more modules are") +
                    " not shown; the terminal has too few rows");
  }
  for (std::string& line : lines) {
    line = shortened(line, screen_.columns);
  }
  return lines;
}

/// Returns the face of each module. The first face of a line begins with the line's name if the line has one.
std::vector<std::vector<std::string>> Watch::all_faces() const {
  const Lamps& lamps = screen_.utf8 ? kRoundLamps : kPlainLamps;
  std::vector<std::vector<std::string>> faces;
  for (const Watched& watched : lines_) {
    const VirtualTime now = watched.present();
    for (std::size_t i = 0; i < watched.line.size(); ++i) {
      faces.push_back(face_text(faces.size() + 1, watched.line.module(i), now, lamps));
      if (i == 0 && !watched.name.empty()) {
        faces.back().insert(faces.back().begin(), "--- " + watched.name);
      }
    }
  }
  return faces;
}

void Watch::print_changes() {
  std::size_t number = 0;
  for (Watched& watched : lines_) {
    const VirtualTime now = watched.present();
    for (std::size_t i = 0; i < watched.line.size(); ++i) {
      const Model& model = watched.line.module(i).model();
      const std::string who = std::to_string(++number) + " " + std::string(model.designation) + ": ";
      std::optional<Face>& known = watched.faces[i];
      const Face face = face_of(watched.line.module(i), now);
      for (const std::string& change : changes_text(model, known ? &*known : nullptr, face)) {
        print_(note_text(now, who + change));
      }
      known = face;
    }
  }
}

}  // namespace ex9000::sim
