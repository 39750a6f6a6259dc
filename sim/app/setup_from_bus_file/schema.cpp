#include "sim/app/setup_from_bus_file/bus_file.hpp"
#include "sim/app/setup_from_bus_file/keys.hpp"

namespace ex9000::sim {

namespace {

using json = nlohmann::ordered_json;

template <class Keys>
json object_of(const Keys& keys, const char* required) {
  json properties = json::object();
  for (const auto& key : keys) {
    json property = json::parse(key.schema);
    property["description"] = key.meaning;
    properties[std::string(key.name)] = std::move(property);
  }
  return {{"type", "object"},
          {"properties", std::move(properties)},
          {"required", json::array({required})},
          {"additionalProperties", false}};
}

}  // namespace

std::string bus_file_schema() {
  json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "A bus file of ex9000-sim"}};
  schema.update(object_of(bus_keys, "lines"));
  schema["$defs"] = {{"line", object_of(line_keys, "modules")}, {"module", object_of(module_keys, "model")}};
  constexpr int kIndent = 2;
  return schema.dump(kIndent) + "\n";
}

}  // namespace ex9000::sim
