// Decides whether words describe a valid fault according to sim/docs/faults.md, independently of the
// simulator's parser.
#pragma once

#include <array>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

namespace ex9000::fuzz {

using Words = std::vector<std::string>;

namespace fault {

using std::chrono::nanoseconds;

template <class Number, class... Format>
std::optional<Number> number(const std::string& text, Format... format) {
  Number value{};
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value, format...);
  return error == std::errc() && rest == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

inline bool is_probability(const std::string& text) {
  const auto value = number<double>(text);
  return value && *value > 0 && *value <= 1;
}

inline std::optional<nanoseconds> time(const std::string& text) {
  // "s" is last, because "us" and "ms" also end with "s".
  constexpr std::array<std::pair<const char*, double>, 5> kUnits{
      {{"us", 1e3}, {"ms", 1e6}, {"min", 60e9}, {"h", 3600e9}, {"s", 1e9}}};
  for (const auto& [unit, length] : kUnits) {
    const std::string ending = unit;
    if (text.size() > ending.size() && text.substr(text.size() - ending.size()) == ending) {
      const auto value =
          number<double>(text.substr(0, text.size() - ending.size()), std::chars_format::fixed);
      constexpr double kYear = 365 * 24 * 3600e9;
      return value && *value >= 0 && *value * length <= kYear
                 ? std::optional(nanoseconds(static_cast<std::int64_t>(*value * length + 0.5)))
                 : std::nullopt;
    }
  }
  return std::nullopt;
}

inline bool is_rate(const std::string& text) {
  const std::set<std::string> rates{"1200", "2400", "4800", "9600", "19200", "38400", "57600", "115200"};
  return rates.count(text) != 0;
}

inline bool is_hex_digits(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789ABCDEFabcdef") == std::string::npos;
}

inline bool is_hex(const std::string& text) { return is_hex_digits(text) && text.size() % 2 == 0; }

inline bool is_ordinal(const std::string& text) {
  if (text.size() < 3) {
    return false;
  }
  const std::string ending = text.substr(text.size() - 2);
  const auto value = number<std::uint64_t>(text.substr(0, text.size() - 2));
  return (ending == "st" || ending == "nd" || ending == "rd" || ending == "th") && value && *value != 0;
}

/// When a fault occurs and how long it lasts. `right` is false if the words are invalid.
struct When {
  bool right = true;
  bool given = false;
  bool of_replies = false;
  std::optional<nanoseconds> every;
  std::optional<nanoseconds> lasts;
};

inline When when(const Words& words, std::size_t at, nanoseconds now) {
  When when;
  const auto word = [&](std::size_t i) { return at + i < words.size() ? words[at + i] : std::string(); };
  while (when.right && at < words.size()) {
    std::size_t used = 2;
    if (word(0) == "for") {
      const bool again = when.lasts.has_value();
      when.lasts = time(word(1));
      when.right = when.lasts && !again;
      at += used;
      continue;
    }
    when.right = !when.given;
    when.given = true;
    if (word(0) == "at") {
      const auto moment = time(word(1));
      when.right = when.right && moment && *moment >= now;
    } else if (word(0) == "every" && word(1) == "reply") {
      when.of_replies = true;
    } else if (word(0) == "every" && is_ordinal(word(1))) {
      when.of_replies = true;
      when.right = when.right && word(2) == "reply";
      used = 3;
    } else if (word(0) == "every") {
      when.every = time(word(1));
      when.right = when.right && when.every >= std::chrono::milliseconds(1);
    } else if (word(0) == "with") {
      when.of_replies = true;
      when.right = when.right && word(1) == "probability" && is_probability(word(2));
      used = 3;
    } else if (word(0) == "after") {
      const auto count = number<std::uint64_t>(word(1));
      when.right = when.right && count && *count != 0 && word(2) == (*count == 1 ? "write" : "writes");
      used = 3;
    } else {
      when.right = false;
    }
    at += used;
  }
  return when;
}

}  // namespace fault

enum class Whose { AnyModules, ThisModules };

/// Returns whether `words` are `KIND [VALUE] [WHEN]` and describe a fault that is permitted for `whose`.
/// `now` is the line time. A fault with an earlier time after `at` is not permitted.
inline bool is_fault(const Words& words, Whose whose, std::chrono::nanoseconds now) {
  using namespace fault;
  if (words.empty()) {
    return false;
  }
  const std::string& kind = words[0];
  const std::string value = words.size() > 1 ? words[1] : "";
  const bool plain =
      kind == "lost-reply" || kind == "gone" || kind == "power-cut" || kind == "hang" || kind == "bad-image";
  const bool noise = kind == "bit-errors" || kind == "lost-bytes" || kind == "inserted-bytes";
  const bool byte = kind == "exception" || kind == "wrong-unit";
  const bool line = noise || kind == "echo" || kind == "foreign-traffic";
  const bool late = kind == "late-reply" || kind == "late-driver";
  const bool has_value = noise                       ? is_probability(value)
                         : byte                      ? value.size() <= 2 && is_hex_digits(value)
                         : kind == "echo"            ? time(value) >= std::chrono::milliseconds(1)
                         : kind == "foreign-traffic" ? is_hex(value)
                         : late                      ? time(value).has_value()
                                                     : kind == "wrong-rate" && is_rate(value);
  if ((!plain && !has_value) || (line && whose == Whose::ThisModules)) {
    return false;
  }
  const When schedule = when(words, plain ? 1 : 2, now);
  const bool moment = kind == "hang" || kind == "foreign-traffic";
  const bool requires_end =
      schedule.every ? !moment && kind != "power-cut"
                     : schedule.of_replies && (kind == "gone" || kind == "wrong-rate" || kind == "bad-image");
  const auto lasts = schedule.lasts        ? schedule.lasts
                     : kind == "power-cut" ? std::optional<nanoseconds>(std::chrono::seconds(1))
                                           : std::nullopt;
  return schedule.right && !(line && schedule.of_replies) && (schedule.lasts ? !moment : !requires_end) &&
         !(schedule.every && lasts && *lasts >= *schedule.every);
}

}  // namespace ex9000::fuzz
