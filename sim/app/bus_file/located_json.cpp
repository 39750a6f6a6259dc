#include "sim/app/bus_file/located_json.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

namespace ex9000::sim {

namespace {

using json = nlohmann::ordered_json;

/// Iterates over the characters of a text and increments `*line` at the end of each line.
class CountingIterator {
 public:
  using difference_type = std::ptrdiff_t;
  using value_type = char;
  using pointer = const char*;
  using reference = const char&;
  using iterator_category = std::input_iterator_tag;

  CountingIterator(const char* at, unsigned* line) : at_(at), line_(line) {}

  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    *line_ += *at_ == '\n' ? 1U : 0U;
    ++at_;
    return *this;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  unsigned* line_;
};

/// Records the line number of each value. A member of an object gets the line of its key, and an element of
/// an array gets its own line. An element that is a number, true, false or null gets the line of the last
/// string, bracket or brace before it, because the parser detects the end of a number only at the next
/// character, which may be on a new line.
class Locator final : public nlohmann::json_sax<json> {
 public:
  explicit Locator(const unsigned& line) : line_(line) {}

  std::map<std::string, unsigned> lines;

  bool null() override { return scalar(); }
  bool boolean(bool /*value*/) override { return scalar(); }
  bool number_integer(number_integer_t /*value*/) override { return scalar(); }
  bool number_unsigned(number_unsigned_t /*value*/) override { return scalar(); }
  bool number_float(number_float_t /*value*/, const string_t& /*text*/) override { return scalar(); }
  bool string(string_t& value) override {
    seen_ = line_;
    reject_nul(value);
    return scalar();
  }
  bool binary(binary_t& /*value*/) override { return scalar(); }
  bool start_object(std::size_t /*elements*/) override { return open(false); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t /*elements*/) override { return open(true); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    seen_ = line_;
    reject_nul(name);
    open_.back().key = name;
    if (!lines.emplace(member_of(open_.back().path, name), line_).second) {
      throw std::invalid_argument(std::to_string(line_) + ": '" + name +
                                  "' is given twice; leave out one of them");
    }
    return true;
  }
  bool parse_error(std::size_t /*position*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    throw std::invalid_argument(located_message(error.what(), line_));
  }

 private:
  struct Open {
    std::string path;
    bool is_array;
    std::size_t next = 0;
    std::string key;
  };

  /// Turns a message of the parser into `LINE: what is wrong`. The message is either
  /// `[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while ...` or, for other
  /// errors, `[json.exception.out_of_range.406] number overflow ...`.
  static std::string located_message(const std::string& text, unsigned line) {
    const std::string lead = "] parse error at line ";
    const auto at = text.find(lead);
    if (at == std::string::npos) {
      return std::to_string(line) + ": " + text.substr(text.find("] ") + 2);
    }
    const auto first = at + lead.size();
    return text.substr(first, text.find(',', first) - first) + text.substr(text.find(": ", first));
  }

  /// Rejects a text that contains NUL, because the operating system would end a path there.
  void reject_nul(const std::string& text) const {
    if (text.find('\0') != std::string::npos) {
      throw std::invalid_argument(std::to_string(line_) + ": a text contains NUL; leave out \\u0000");
    }
  }

  std::string place() {
    if (open_.empty()) {
      return "";
    }
    Open& around = open_.back();
    return around.is_array ? element_of(around.path, around.next++) : member_of(around.path, around.key);
  }

  bool scalar() {
    lines.emplace(place(), seen_);
    return true;
  }

  bool open(bool is_array) {
    // No bus file requires more levels than kDeepest. Without this limit, a deeply nested file would take
    // much memory, because this class stores the whole path of each value.
    constexpr std::size_t kDeepest = 16;
    if (open_.size() == kDeepest) {
      throw std::invalid_argument(std::to_string(line_) +
                                  ": has too many levels of lists and objects; see 'ex9000-sim --schema'");
    }
    seen_ = line_;
    const std::string path = place();
    lines.emplace(path, line_);
    open_.push_back({path, is_array, 0, ""});
    return true;
  }

  bool close() {
    seen_ = line_;
    open_.pop_back();
    return true;
  }

  const unsigned& line_;
  unsigned seen_ = 1;
  std::vector<Open> open_;
};

}  // namespace

std::string member_of(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

std::string element_of(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

LocatedJson parse_located(const std::string& text) {
  unsigned line = 1;
  Locator locator(line);
  json::sax_parse(CountingIterator(text.data(), &line), CountingIterator(text.data() + text.size(), &line),
                  &locator);
  return {json::parse(text), std::move(locator.lines)};
}

}  // namespace ex9000::sim
