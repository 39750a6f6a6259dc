#include "sim/app/setup_from_bus_file/node.hpp"

namespace ex9000::sim {

std::string Node::text() const {
  if (!value_->is_string()) {
    refuse("expected a text in quotes");
  }
  return value_->get<std::string>();
}

bool Node::flag() const {
  if (!value_->is_boolean()) {
    refuse("expected true or false");
  }
  return value_->get<bool>();
}

std::string Node::number_or_text() const {
  if (!value_->is_number_unsigned() && !value_->is_string()) {
    refuse("expected a whole number or a text in quotes");
  }
  return value_->is_number_unsigned() ? value_->dump() : text();
}

std::string Node::flag_or_text() const {
  if (!value_->is_boolean() && !value_->is_string()) {
    refuse("expected true, false or a text in quotes");
  }
  return value_->is_boolean() ? (value_->get<bool>() ? "on" : "off") : text();
}

std::string Node::setting() const {
  if (!value_->is_boolean() && !value_->is_number_unsigned() && !value_->is_string()) {
    refuse("expected a text in quotes, a whole number, true or false");
  }
  return value_->is_number_unsigned() ? number_or_text() : flag_or_text();
}

void Node::refuse_at(const std::string& path, const std::string& what) const {
  throw Located(place_of(path) + (path.empty() ? "" : path + ": ") + what);
}

/// Returns `FILE:LINE: ` for the value at `path`. If the file does not contain this value, LINE is the line
/// of the innermost object or list on this path that the file contains.
std::string Node::place_of(const std::string& path) const {
  std::string place = path;
  while (file_->lines.find(place) == file_->lines.end()) {
    const auto end = place.find_last_of(".[");
    place.resize(end == std::string::npos ? 0 : end);
  }
  return *name_ + ":" + std::to_string(file_->lines.at(place)) + ": ";
}

}  // namespace ex9000::sim
