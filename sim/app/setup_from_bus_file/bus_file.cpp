#include "sim/app/setup_from_bus_file/bus_file.hpp"

#include <sstream>

#include "sim/app/setup_from_bus_file/keys.hpp"
#include "sim/app/setup_from_bus_file/located_json.hpp"
#include "sim/app/setup_from_bus_file/node.hpp"
#include "sim/files_and_ports/files/regular_file.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

/// Returns the path of the value that `error` concerns, from the root of the file.
std::string path_of(const SetupError& error) {
  std::string object;
  if (error.line) {
    object = element_of("lines", *error.line);
  }
  if (error.module) {
    object = element_of(member_of(object, "modules"), *error.module);
  }
  return member_of(object, error.key);
}

}  // namespace

bool is_bus_file(const std::string& argument) {
  const std::string ending = ".json";
  const auto comma = argument.find(',');
  const bool has_settings = comma != std::string::npos && argument.find('=', comma) != std::string::npos &&
                            argument.find('/') > comma;
  return !has_settings && argument.size() > ending.size() &&
         argument.compare(argument.size() - ending.size(), ending.size(), ending) == 0;
}

Setup parse_bus_file(const std::string& path, const std::string& text) {
  const LocatedJson file = with_place(path + ":", [&] { return parse_located(text); });
  const Node root(file, path);
  Setup setup = read_bus(root);
  try {
    check(setup);
  } catch (const SetupError& error) {
    root.refuse(path_of(error), error.named([](const std::string& key, const std::string& value) {
      return "'" + key + "'" + value;
    }));
  }
  return setup;
}

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
