// A value of a bus file, with its place in the file for error messages.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "sim/app/setup_from_bus_file/located_json.hpp"

namespace ex9000::sim {

/// The functions report errors as std::invalid_argument with a one-line message, `FILE:LINE: PATH: TEXT`.
/// TEXT says what is wrong or what is expected. PATH is the path of the value, for example `lines[0].baud`.
/// The message has no PATH if the value is the whole file.
class Node {
 public:
  using json = nlohmann::ordered_json;

  /// Represents the whole file. `name` is the file's path in messages. `file` and `name` must outlive this
  /// object and the nodes made from it.
  Node(const LocatedJson& file, const std::string& name) : Node(file, name, file.value, "") {}

  [[noreturn]] void refuse(const std::string& what) const { refuse_at(path_, what); }
  /// Reports an error in a value below this one, even if that value is missing. `path` is relative to this
  /// node.
  [[noreturn]] void refuse(const std::string& path, const std::string& what) const {
    refuse_at(member_of(path_, path), what);
  }

  /// Returns the place as messages show it, `FILE:LINE: PATH`.
  [[nodiscard]] std::string place() const { return place_of(path_) + path_; }

  /// Returns the key of this node, which must be a member of an object.
  [[nodiscard]] std::string key() const { return path_.substr(path_.rfind('.') + 1); }

  /// Calls `take(key, member)` for each member of this object. Adds the place of the member to an error of
  /// `take` that has no place yet. Reports an error if this value is not an object.
  template <class Take>
  void members(Take take) const {
    if (!value_->is_object()) {
      refuse("expected an object, { }");
    }
    for (const auto& item : value_->items()) {
      const Node member(*file_, *name_, item.value(), member_of(path_, item.key()));
      member.guarded([&] { take(item.key(), member); });
    }
  }

  /// Calls `take(element)` for each element of this list. Reports errors in the same way as `members`.
  template <class Take>
  void elements(Take take) const {
    if (!value_->is_array()) {
      refuse("expected a list, [ ]");
    }
    for (std::size_t i = 0; i < value_->size(); ++i) {
      const Node element(*file_, *name_, (*value_)[i], element_of(path_, i));
      element.guarded([&] { take(element); });
    }
  }

  [[nodiscard]] std::string text() const;
  [[nodiscard]] bool flag() const;
  /// Returns a whole number or a text, as text.
  [[nodiscard]] std::string number_or_text() const;
  /// Returns a text; true and false become on and off.
  [[nodiscard]] std::string flag_or_text() const;
  /// Returns a whole number or a text, as text; true and false become on and off.
  [[nodiscard]] std::string setting() const;

 private:
  struct Located : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
  };

  Node(const LocatedJson& file, const std::string& name, const json& value, std::string path)
      : file_(&file), name_(&name), value_(&value), path_(std::move(path)) {}

  /// Runs `action`. Adds this node's place to each error of `action` that has no place yet.
  template <class Action>
  void guarded(Action action) const {
    try {
      action();
    } catch (const Located&) {
      throw;
    } catch (const std::invalid_argument& error) {
      refuse(error.what());
    }
  }

  [[noreturn]] void refuse_at(const std::string& path, const std::string& what) const;
  [[nodiscard]] std::string place_of(const std::string& path) const;

  const LocatedJson* file_;
  const std::string* name_;
  const json* value_;
  std::string path_;
};

}  // namespace ex9000::sim
