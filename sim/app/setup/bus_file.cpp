#include "sim/app/setup/bus_file.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "sim/files_and_ports/files/regular_file.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/notation/module_settings.hpp"
#include "sim/text/embedded_files.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

using YAML::Node;

class BusFileReader {
 public:
  explicit BusFileReader(const std::string& path) : path_(path) {}

  [[nodiscard]] Setup bus(const Node& root) const {
    Setup setup;
    setup.file = path_;
    const Part lines{"lines",
                     "a bus file requires at least one line; 'ex9000-sim --example' prints an example"};
    read(root, run_settings, setup, lines, [&](const Node& list) {
      for (const Node& line : elements_of(list, lines)) {
        setup.lines.push_back(read_line(line));
      }
    });
    return setup;
  }

 private:
  /// A key that an object must have.
  struct Part {
    std::string key;
    std::string if_missing;
  };

  [[nodiscard]] LineSetup read_line(const Node& node) const {
    LineSetup line;
    line.places["port"] = place(node) + "port: ";  // for what the file does not name
    line.places["name"] = place(node) + "name: ";
    const Part modules{"modules", "a line requires at least one module, for example EX9042D-M@01"};
    read(node, line_settings, line, modules, [&](const Node& list) {
      for (const Node& module : elements_of(list, modules)) {
        line.modules.push_back(read_module(module));
      }
    });
    return line;
  }

  [[nodiscard]] ModuleSpec read_module(const Node& node) const {
    ModuleSpec module;
    if (node.IsScalar()) {
      module = with_place(place(node), [&] { return parse_module_spec(text_of(node)); });
      prefix_places(module.places, place(node));
      return module;
    }
    const Part model{"model", "is missing; expected a model's name, for example EX9042D-M"};
    read(node, module_settings, module, model, [&](const Node& name) {
      module =
          with_place(place(name) + "model: ", [&] { return factory_fresh(model_called(text_of(name))); });
    });
    with_place(place(node), [&] { check(module); });
    return module;
  }

  /// First the value of `part`, because the settings may depend on it; then the settings in the order of
  /// `settings`, because some depend on those before.
  template <class Settings, class Object, class TakePart>
  void read(const Node& node, const Settings& settings, Object& object, const Part& part,
            TakePart take_part) const {
    const std::map<std::string, Member> members = members_of(node, part.key + ", " + names_of(settings));
    const auto has_part = members.find(part.key);
    if (has_part == members.end()) {
      refuse(node, part.key + ": " + part.if_missing);
    }
    take_part(has_part->second.value);
    for (const auto& setting : settings) {
      const auto member = members.find(std::string(setting.name));
      if (member == members.end()) {
        continue;
      }
      const Node& values = member->second.value;
      const auto take = [&](const Node& value) {
        const bool is_element = values.IsSequence() && setting.form == Form::List;
        const std::string where = place(is_element ? value : member->second.key) + member->first + ": ";
        take_setting(setting, object, where,
                     with_place(where, [&] { return value_of(value, setting.form); }));
      };
      if (setting.form == Form::List && values.IsSequence()) {
        std::for_each(values.begin(), values.end(), take);
      } else {
        take(values);
      }
    }
  }

  [[nodiscard]] const Node& elements_of(const Node& list, const Part& part) const {
    if (!list.IsSequence()) {
      refuse(list, part.key + ": expected a list");
    }
    if (list.size() == 0) {
      refuse(list, part.key + ": " + part.if_missing);
    }
    return list;
  }

  struct Member {
    Node key;
    Node value;
  };

  /// `known`: the keys, separated by commas.
  [[nodiscard]] std::map<std::string, Member> members_of(const Node& node, const std::string& known) const {
    if (!node.IsMap()) {
      refuse(node, "expected keys with values, for example 'name: hall'");
    }
    const std::string one_of = ": unknown key; expected one of " + known;
    const auto is_known = [list = ", " + known + ", "](const std::string& key) {
      return list.find(", " + key + ", ") != std::string::npos;
    };
    std::map<std::string, Member> members;
    for (const auto& member : node) {
      const std::string key = with_place(place(member.first), [&] { return text_of(member.first); });
      if (!is_known(key)) {
        refuse(member.first, key + one_of);
      }
      if (!members.emplace(key, Member{member.first, member.second}).second) {
        refuse(member.first, key + ": is given twice; leave out one of them");
      }
    }
    return members;
  }

  /// Rejects NUL: the operating system would end a path there.
  [[nodiscard]] static std::string text_of(const Node& node) {
    if (!node.IsScalar()) {
      fail(node.IsNull() ? "has no value; write one, or leave the key out" : "expected a single value");
    }
    if (node.Scalar().find('\0') != std::string::npos) {
      fail("contains NUL; leave out \\0");
    }
    return node.Scalar();
  }

  [[nodiscard]] static std::string value_of(const Node& node, Form form) {
    const std::string text = text_of(node);
    const bool switches = form == Form::Flag || form == Form::Optional;
    return switches && text == "true" ? "on" : switches && text == "false" ? "off" : text;
  }

  /// `FILE:LINE: `
  [[nodiscard]] std::string place(const Node& node) const {
    const YAML::Mark mark = node.Mark();
    return path_ + ":" + (mark.is_null() ? "" : std::to_string(mark.line + 1) + ":") + " ";
  }

  [[noreturn]] void refuse(const Node& node, const std::string& what) const { fail(place(node) + what); }

  const std::string& path_;
};

/// Where the last document begins. YAML::LoadAll never ends at a surplus bracket, which it takes for one.
struct DocumentStart final : YAML::EventHandler {
  using Mark = YAML::Mark;
  using Text = std::string;
  using Style = YAML::EmitterStyle::value;

  int line = 1;

  void OnDocumentStart(const Mark& mark) override { line = mark.line + 1; }
  void OnDocumentEnd() override {}
  void OnNull(const Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnAlias(const Mark& /*mark*/, YAML::anchor_t /*anchor*/) override {}
  void OnScalar(const Mark& /*mark*/, const Text& /*tag*/, YAML::anchor_t /*anchor*/,
                const Text& /*value*/) override {}
  void OnSequenceStart(const Mark& /*mark*/, const Text& /*tag*/, YAML::anchor_t /*anchor*/,
                       Style /*style*/) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const Mark& /*mark*/, const Text& /*tag*/, YAML::anchor_t /*anchor*/,
                  Style /*style*/) override {}
  void OnMapEnd() override {}
};

}  // namespace

bool is_bus_file(const std::string& argument) {
  const auto comma = argument.find(',');
  const bool has_settings = comma != std::string::npos && argument.find('=', comma) != std::string::npos &&
                            argument.find('/') > comma;
  const auto ends_with = [&argument](const std::string& ending) {
    return argument.size() > ending.size() &&
           argument.compare(argument.size() - ending.size(), ending.size(), ending) == 0;
  };
  return !has_settings && (ends_with(".yaml") || ends_with(".yml") || ends_with(".json"));
}

Setup parse_bus_file(const std::string& path, const std::string& text) {
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    DocumentStart start;
    const bool is_empty = !parser.HandleNextDocument(start);
    if (is_empty || parser.HandleNextDocument(start)) {
      fail(path + ":" + std::to_string(start.line) + ": expected " +
           (is_empty ? "a bus file, as 'ex9000-sim --example' prints it" : "the end of the file"));
    }
    return BusFileReader(path).bus(YAML::Load(text));
  } catch (const YAML::Exception& error) {
    fail(path + ":" + std::to_string(error.mark.is_null() ? 1 : error.mark.line + 1) + ": " + error.msg);
  }
}

std::string example_bus_file() { return std::string(bus_file_examples().front().content); }

Setup read_bus_file(const std::string& path) {
  const std::ifstream file = open_text_file(path);
  if (!file.is_open()) {
    fail(path + ": is not a file that can be read; 'ex9000-sim --example' prints a bus file");
  }
  std::ostringstream text;
  text << file.rdbuf();
  return parse_bus_file(path, text.str());
}

}  // namespace ex9000::sim
