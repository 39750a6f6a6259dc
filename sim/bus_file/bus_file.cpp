#include "sim/bus_file/bus_file.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

#include "sim/bus_file/located_json.hpp"
#include "sim/fail.hpp"

namespace ex9000::sim {

namespace {

using json = nlohmann::ordered_json;

/// A value of the file, and where it stands.
class Node {
 public:
  Node(const LocatedJson& file, const std::string& name, const json& value, std::string path)
      : file_(&file), name_(&name), value_(&value), path_(std::move(path)) {}

  [[noreturn]] void refuse(const std::string& what) const { refuse_at(path_, what); }
  /// Of a member that may be missing.
  [[noreturn]] void refuse(const std::string& key, const std::string& what) const {
    refuse_at(member_of(path_, key), what);
  }

  /// For people: the file, its line, and what is described there.
  [[nodiscard]] std::string place() const { return place_of(path_) + path_; }

  /// Calls `take` with each member's key and value; it returns false for a key that it does not know.
  template <class Take>
  void members(const std::string& there_are, Take take) const {
    if (!value_->is_object()) {
      refuse("wants an object, { }");
    }
    for (const auto& item : value_->items()) {
      const Node member(*file_, *name_, item.value(), member_of(path_, item.key()));
      bool known = false;
      member.guarded([&] { known = take(item.key(), member); });
      if (!known) {
        member.refuse("no such key; there are " + there_are);
      }
    }
  }

  template <class Take>
  void elements(Take take) const {
    if (!value_->is_array()) {
      refuse("wants a list, [ ]");
    }
    for (std::size_t i = 0; i < value_->size(); ++i) {
      const Node element(*file_, *name_, (*value_)[i], element_of(path_, i));
      element.guarded([&] { take(element); });
    }
  }

  /// Calls `take` with the member of this key, if there is one.
  template <class Take>
  void member(const std::string& key, Take take) const {
    const auto found = value_->find(key);
    if (found != value_->end()) {
      const Node member(*file_, *name_, *found, member_of(path_, key));
      member.guarded([&] { take(member); });
    }
  }

  [[nodiscard]] std::string text() const {
    if (!value_->is_string()) {
      refuse("wants a text in quotes");
    }
    return value_->get<std::string>();
  }

  [[nodiscard]] bool flag() const {
    if (!value_->is_boolean()) {
      refuse("wants true or false");
    }
    return value_->get<bool>();
  }

  /// A number, or a text, as text.
  [[nodiscard]] std::string number_or_text() const {
    if (value_->is_number_unsigned()) {
      return std::to_string(value_->get<std::uint64_t>());
    }
    if (!value_->is_string()) {
      refuse("wants a whole number");
    }
    return value_->get<std::string>();
  }

  /// Likewise, and true and false as on and off.
  [[nodiscard]] std::string setting() const {
    if (!value_->is_boolean() && !value_->is_number_unsigned() && !value_->is_string()) {
      refuse("wants a text in quotes, a whole number, or true or false");
    }
    return value_->is_boolean() ? (value_->get<bool>() ? "on" : "off") : number_or_text();
  }

 private:
  struct Located : std::invalid_argument {
    using std::invalid_argument::invalid_argument;
  };

  /// Whatever else is thrown below gets this place.
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

  /// What is not in the file is told of what it should stand in.
  [[noreturn]] void refuse_at(const std::string& path, const std::string& what) const {
    throw Located(place_of(path) + (path.empty() ? "" : path + ": ") + what);
  }

  [[nodiscard]] std::string place_of(const std::string& path) const {
    std::string place = path;
    while (file_->lines.find(place) == file_->lines.end()) {
      const auto end = place.find_last_of(".[");
      place.resize(end == std::string::npos ? 0 : end);
    }
    return *name_ + ":" + std::to_string(file_->lines.at(place)) + ": ";
  }

  const LocatedJson* file_;
  const std::string* name_;
  const json* value_;
  std::string path_;
};

void read_module(const Node& node, LineSetup& line) {
  const Model* model = nullptr;
  node.member("model", [&](const Node& name) { model = &model_called(name.text()); });
  if (model == nullptr) {
    node.refuse("model", "wants the model's name in quotes");
  }
  ModuleSpec spec = factory_fresh(*model);
  const std::size_t position = line.modules.size();
  node.members("model, address, protocol, baud, checksum, edge, name, init, eeprom, inputs and faults",
               [&](const std::string& key, const Node& value) {
                 if (key == "address") {
                   set_address(spec, value.text());
                 } else if (key == "inputs") {
                   value.elements([&](const Node& input) {
                     spec.inputs.push_back(parse_input_program(input.text(), *spec.model));
                   });
                 } else if (key == "faults") {
                   value.elements([&](const Node& text) {
                     Fault fault = parse_fault(text.text());
                     if (!befalls_a_module(fault.trouble)) {
                       text.refuse("befalls the line; put it into the line's faults");
                     }
                     fault.module = position;
                     line.faults.push_back(fault);
                   });
                 } else if (key == "protocol" || key == "baud" || key == "checksum" || key == "edge" ||
                            key == "name" || key == "init" || key == "eeprom") {
                   apply_setting(spec, key, value.setting());
                 } else if (key != "model") {
                   return false;
                 }
                 return true;
               });
  check(spec);
  line.modules.push_back(std::move(spec));
}

void read_line(const Node& node, Setup& setup) {
  LineSetup line;
  line.place = node.place();
  node.members(
      "name, pty, tcp, serial, echo, baud, line, strict-gaps, modules and faults",
      [&](const std::string& key, const Node& value) {
        if (key == "name") {
          line.name = value.text();
        } else if (key == "pty") {
          line.pty = value.text();
        } else if (key == "tcp") {
          line.tcp = parse_tcp_address(value.number_or_text());
        } else if (key == "serial") {
          line.serial = value.text();
        } else if (key == "echo") {
          line.echo = value.flag();
        } else if (key == "baud") {
          line.baud = parse_line_rate(value.number_or_text());
        } else if (key == "line") {
          line.instant = parse_line_kind(value.text());
        } else if (key == "strict-gaps") {
          line.strict_gaps = value.flag();
        } else if (key == "modules") {
          value.elements([&](const Node& module) { read_module(module, line); });
        } else if (key == "faults") {
          value.elements([&](const Node& fault) { line.faults.push_back(parse_fault(fault.text())); });
        } else {
          return false;
        }
        return true;
      });
  if (line.modules.empty()) {
    node.refuse("modules", R"(a line wants at least one module, {"model": "EX9042D-M"})");
  }
  if (line.name.empty()) {
    line.name = "line" + std::to_string(setup.lines.size() + 1);
  }
  setup.lines.push_back(std::move(line));
}

Setup read_setup(const Node& root) {
  Setup setup;
  root.members("lines, control, panel, watch, log, capture and seed",
               [&](const std::string& key, const Node& value) {
                 setup.places[key] = value.place();
                 if (key == "lines") {
                   value.elements([&](const Node& line) { read_line(line, setup); });
                 } else if (key == "control") {
                   setup.control = value.text();
                 } else if (key == "watch") {
                   setup.watch = value.flag();
                 } else if (key == "panel") {
                   const std::string panel = value.setting();
                   setup.panel = parse_panel(panel == "on" ? "" : panel);
                 } else if (key == "log") {
                   const std::string log = value.setting();
                   setup.log = parse_log(log == "on" ? "text" : log);
                 } else if (key == "capture") {
                   setup.capture = value.text();
                 } else if (key == "seed") {
                   setup.seed = parse_seed(value.number_or_text());
                 } else {
                   return false;
                 }
                 return true;
               });
  if (setup.lines.empty()) {
    root.refuse("lines", "a bus wants at least one line; --example prints one");
  }
  return setup;
}

LocatedJson json_of(const std::string& path, const std::string& text) {
  try {
    return parse_located(text);
  } catch (const std::invalid_argument& error) {
    fail(path + ":" + error.what());
  }
}

}  // namespace

bool is_bus_file(const std::string& argument) {
  const std::string ending = ".json";
  return argument.size() > ending.size() &&
         argument.compare(argument.size() - ending.size(), ending.size(), ending) == 0;
}

Setup parse_bus_file(const std::string& path, const std::string& text) {
  const LocatedJson file = json_of(path, text);
  const Node root(file, path, file.value, "");
  Setup setup = read_setup(root);
  try {
    check(setup);
  } catch (const WrongSetup& wrong) {
    std::string object;
    if (wrong.line) {
      object = element_of("lines", *wrong.line);
    }
    if (wrong.module) {
      object = element_of(member_of(object, "modules"), *wrong.module);
    }
    root.refuse(member_of(object, wrong.key), wrong.what());
  }
  return setup;
}

Setup read_bus_file(const std::string& path) {
  const std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file || std::filesystem::is_directory(path)) {  // which can be opened
    fail(path + ": cannot be read; --example prints a bus file");
  }
  return parse_bus_file(path, text.str());
}

}  // namespace ex9000::sim
