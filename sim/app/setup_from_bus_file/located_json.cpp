#include "sim/app/setup_from_bus_file/located_json.hpp"

#include <algorithm>
#include <ios>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

using json = nlohmann::ordered_json;

/// Records the line number of each value. A member of an object gets the line of its key. An element of an
/// array that is a string, an array or an object gets its own line. Any other element gets the line of the
/// last string, bracket or brace before it, because the parser detects the end of a number only at the next
/// character, which may be on a new line.
class Locator {
 public:
  using Event = json::parse_event_t;

  /// The parser reads `text` from `buffer`. Both must outlive this object.
  Locator(const std::string& text, std::streambuf& buffer) : text_(text), buffer_(buffer) {}

  std::map<std::string, unsigned> lines;

  /// Returns the number of the line that the parser has reached.
  unsigned line() {
    const std::streamoff reached = buffer_.pubseekoff(0, std::ios::cur, std::ios::in);
    line_ += static_cast<unsigned>(std::count(text_.begin() + reached_, text_.begin() + reached, '\n'));
    reached_ = reached;
    return line_;
  }

  /// Takes an event of the parser. `parsed` is the key or the value that the parser has read.
  void take(Event event, const json& parsed) {
    if (event != Event::value || parsed.is_string()) {
      seen_ = line();
    }
    if (parsed.is_string()) {
      reject_nul(parsed.get_ref<const std::string&>());
    }
    if (event == Event::key) {
      add_key(parsed.get<std::string>());
    } else if (event == Event::value) {
      add_value();
    } else if (event == Event::object_start || event == Event::array_start) {
      open(event == Event::array_start);
    } else {
      open_.pop_back();
    }
  }

 private:
  struct Open {
    std::string path;
    bool is_array;
    std::size_t next = 0;
    std::string key;
    std::set<std::string> keys;
  };

  [[noreturn]] void refuse(const std::string& what) const { fail(std::to_string(seen_) + ": " + what); }

  /// Rejects a text that contains NUL, because the operating system would end a path there.
  void reject_nul(const std::string& text) const {
    if (text.find('\0') != std::string::npos) {
      refuse("a text contains NUL; leave out \\u0000");
    }
  }

  void add_key(const std::string& key) {
    Open& object = open_.back();
    object.key = key;
    if (!object.keys.insert(key).second) {
      refuse("'" + key + "' is given twice; leave out one of them");
    }
    lines.emplace(member_of(object.path, key), seen_);
  }

  /// Records the line of the next value, and returns the path of the value.
  std::string add_value() {
    std::string path;
    if (!open_.empty()) {
      Open& around = open_.back();
      path = around.is_array ? element_of(around.path, around.next++) : member_of(around.path, around.key);
    }
    lines.emplace(path, seen_);
    return path;
  }

  void open(bool is_array) {
    // No bus file requires more levels than kDeepest. Without this limit, a deeply nested file would take
    // much memory, because this class stores the whole path of each value.
    constexpr std::size_t kDeepest = 16;
    if (open_.size() == kDeepest) {
      refuse("has too many levels of lists and objects; see 'ex9000-sim --schema'");
    }
    open_.push_back({add_value(), is_array, 0, "", {}});
  }

  const std::string& text_;
  std::streambuf& buffer_;
  std::streamoff reached_ = 0;
  unsigned line_ = 1;
  unsigned seen_ = 1;  ///< line of the last key, string, bracket or brace
  std::vector<Open> open_;
};

/// Turns a message of the parser into `LINE: what is wrong`. The message is either
/// `[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while ...` or, for other
/// errors, `[json.exception.out_of_range.406] number overflow ...`.
std::string located_message(const std::string& text, unsigned line) {
  const std::string lead = "] parse error at line ";
  const auto at = text.find(lead);
  if (at == std::string::npos) {
    return std::to_string(line) + ": " + text.substr(text.find("] ") + 2);
  }
  const auto first = at + lead.size();
  return text.substr(first, text.find(',', first) - first) + text.substr(text.find(": ", first));
}

}  // namespace

std::string member_of(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

std::string element_of(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

LocatedJson parse_located(const std::string& text) {
  std::istringstream stream(text);
  Locator locator(text, *stream.rdbuf());
  const auto take = [&locator](int /*depth*/, json::parse_event_t event, const json& parsed) {
    locator.take(event, parsed);
    return true;
  };
  try {
    json value = json::parse(stream, take);
    return {std::move(value), std::move(locator.lines)};
  } catch (const json::exception& error) {
    fail(located_message(error.what(), locator.line()));
  }
}

}  // namespace ex9000::sim
