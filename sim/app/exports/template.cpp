#include "sim/app/exports/template.hpp"

#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void reject(std::string_view tag, const char* what) {
  throw std::logic_error("{{" + std::string(tag) + "}}: " + what);
}

/// Joins lines that consist of tags without a value to the lines after them.
std::string without_lines_of_tags(std::string_view text) {
  const std::regex only_tags(R"( *((\{\{[#^/!][^}]*\}\})+) *)");
  std::istringstream lines{std::string(text)};
  std::string joined;
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    joined += std::regex_match(line, match, only_tags) ? match.str(1) : line + "\n";
  }
  return joined;
}

class Filling {
 public:
  Filling(std::string_view text, const Json& data) : rest_(text), scopes_{{&data, false}} {}

  /// To the end of a section, or the whole text if `section` is empty. Without `prints`, empty.
  std::string up_to_end_of(std::string_view section, bool prints) {
    std::string text;
    for (std::size_t at = rest_.find("{{"); at != std::string_view::npos; at = rest_.find("{{")) {
      const std::size_t end = rest_.find("}}", at);
      if (end == std::string_view::npos) {
        reject(rest_.substr(at + 2, rest_.find('\n', at) - at - 2), "is not closed");
      }
      const std::string_view tag = rest_.substr(at + 2, end - at - 2);
      text += prints ? rest_.substr(0, at) : "";
      rest_.remove_prefix(end + 2);
      const char kind = tag.empty() ? '\0' : tag.front();
      if (kind == '#' || kind == '^') {
        text += section_of(tag, prints);
      } else if (kind == '/') {
        if (tag.substr(1) != section) {
          reject(tag, "ends another section");
        }
        return text;
      } else if (kind != '!' && prints) {
        text += value_of(tag);
      }
    }
    if (!section.empty()) {
      reject(section, "the section has no end");
    }
    return text + std::string(rest_);
  }

 private:
  struct Scope {
    const Json* value;
    bool more;
  };

  std::string section_of(std::string_view tag, bool prints) {
    const std::string_view name = tag.substr(1, tag.find('=') - 1);
    std::vector<Scope> rounds = prints ? rounds_of(tag.substr(1)) : std::vector<Scope>{};
    if (prints && tag.front() == '^') {
      rounds = once(rounds.empty());
    }
    if (rounds.empty()) {
      up_to_end_of(name, false);
    }
    const std::string_view body = rest_;
    std::string text;
    for (const Scope& round : rounds) {
      rest_ = body;
      scopes_.push_back(round);
      text += up_to_end_of(name, true);
      scopes_.pop_back();
    }
    return text;
  }

  /// The section is printed for each of them.
  [[nodiscard]] std::vector<Scope> rounds_of(std::string_view condition) const {
    if (condition == "more") {
      return once(scopes_.back().more);
    }
    if (const std::size_t sign = condition.find('='); sign != std::string_view::npos) {
      const std::string value = "|" + value_of(condition.substr(0, sign)) + "|";
      const std::string choices = "|" + std::string(condition.substr(sign + 1)) + "|";
      return once(choices.find(value) != std::string::npos);
    }
    const Json& value = found(condition);
    if (!value.is_array()) {
      return once(!value.empty() && value != false && value != 0);
    }
    std::vector<Scope> rounds;
    for (const Json& element : value) {
      rounds.push_back({&element, &element != &value.back()});
    }
    return rounds;
  }

  [[nodiscard]] std::vector<Scope> once(bool holds) const {
    return holds ? std::vector<Scope>{scopes_.back()} : std::vector<Scope>{};
  }

  [[nodiscard]] std::string value_of(std::string_view tag) const {
    const std::size_t sign = tag.find_first_of("|*-");
    const Json& value = found(tag.substr(0, sign));
    if (sign == std::string_view::npos) {
      return value.is_string() ? value.get<std::string>() : value.is_null() ? "" : value.dump(2);
    }
    const auto number = value.get<unsigned>();
    const std::string operand(tag.substr(sign + 1));
    switch (tag[sign]) {
      case '*':
        return std::to_string(number * std::stoul(operand));
      case '-':
        return std::to_string(number - std::stoul(operand));
      default:
        return operand == "hex4" ? hex_word_text(number) : hex_byte_text(number);
    }
  }

  /// In the innermost object that has one.
  [[nodiscard]] const Json& found(std::string_view name) const {
    if (name == ".") {
      return *scopes_.back().value;
    }
    const std::size_t dot = name.find('.');
    const std::string first(name.substr(0, dot));
    for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
      if (scope->value->contains(first)) {
        const Json& value = scope->value->at(first);
        return dot == std::string_view::npos ? value : value.at(std::string(name.substr(dot + 1)));
      }
    }
    reject(name, "there is no such name");
  }

  std::string_view rest_;
  std::vector<Scope> scopes_;
};

}  // namespace

std::string filled_in(std::string_view text, const Json& data) {
  const std::string tidy = without_lines_of_tags(text);
  return Filling(tidy, data).up_to_end_of("", true);
}

}  // namespace ex9000::sim
