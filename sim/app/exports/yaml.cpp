#include "sim/app/exports/yaml.hpp"

#include <string_view>

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// Returns whether the text is a word that YAML 1.1 reads as true, false or null. Ignores the case of the
/// letters.
bool reads_as_other_type(const std::string& text) {
  std::string lower = text;
  for (char& character : lower) {
    character = static_cast<char>(character >= 'A' && character <= 'Z' ? character - 'A' + 'a' : character);
  }
  for (const char* word : {"true", "false", "yes", "no", "on", "off", "y", "n", "null"}) {
    if (lower == word) {
      return true;
    }
  }
  return false;
}

/// Returns whether the string is simple enough to be written without quotes. Other strings are written in
/// quotes as in JSON, which YAML accepts.
bool is_plain(const std::string& text) {
  return !text.empty() && kLetters.find(text.front()) != std::string_view::npos && text.back() != ' ' &&
         text.find_first_not_of(std::string(kLetters) + "0123456789_ -") == std::string::npos &&
         !reads_as_other_type(text);
}

std::string scalar(const Json& value) {
  return value.is_string() && is_plain(value.get<std::string>()) ? value.get<std::string>() : value.dump();
}

bool is_block(const Json& value) { return value.is_structured() && !value.empty(); }

void write(const Json& value, const std::string& indent, std::string& text);

/// Writes an item of an array after `- `. The first line of the item therefore has no indentation.
void write_item(const Json& value, const std::string& indent, std::string& text) {
  std::string block;
  if (is_block(value)) {
    write(value, indent, block);
    text += block.substr(indent.size());
  } else {
    text += scalar(value) + "\n";
  }
}

void write(const Json& value, const std::string& indent, std::string& text) {
  if (value.is_array()) {
    for (const Json& item : value) {
      text += indent + "- ";
      write_item(item, indent + "  ", text);
    }
    return;
  }
  for (const auto& [key, item] : value.items()) {
    text += indent + key + ":";
    if (is_block(item)) {
      text += "\n";
      write(item, indent + "  ", text);
    } else {
      text += " " + scalar(item) + "\n";
    }
  }
}

}  // namespace

std::string yaml_of(const Json& value) {
  std::string text;
  if (is_block(value)) {
    write(value, "", text);
  } else {
    text = scalar(value) + "\n";
  }
  return text;
}

}  // namespace ex9000::sim
