#include "sim/app/setup/schema.hpp"

#include <nlohmann/json.hpp>

#include "sim/app/setup/setup.hpp"
#include "sim/notation/module_settings.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

/// The words of a choice, and those that are numbers also as numbers, as YAML and JSON read them.
Json choices_of(std::string_view value) {
  Json choices = Json::array();
  for (const std::string& word : parts_of(std::string(value), '|')) {
    if (word.find_first_not_of("0123456789") == std::string::npos) {
      choices.push_back(std::stoul(word));
    }
    choices.push_back(word);
  }
  return choices;
}

Json form_of(Form form, std::string_view value) {
  switch (form) {
    case Form::Flag:
      return {{"enum", {true, false, "on", "off"}}};
    case Form::Choice:
      return {{"enum", choices_of(value)}};
    case Form::Optional:
      return {{"type", {"boolean", "integer", "string"}}};
    case Form::List:
      return {{"type", {"array", "string"}}, {"items", {{"type", "string"}}}};
    case Form::Text:
      break;
  }
  return {{"type", {"string", "number"}}};
}

template <class Settings>
Json object_of(const Settings& settings, const char* part, Json part_schema) {
  Json properties{{part, std::move(part_schema)}};
  for (const auto& setting : settings) {
    Json property = form_of(setting.form, setting.value);
    property["description"] = setting.does;
    properties[std::string(setting.name)] = std::move(property);
  }
  return {{"type", "object"},
          {"properties", std::move(properties)},
          {"required", Json::array({part})},
          {"additionalProperties", false}};
}

Json list_of(const char* what, const char* description) {
  return {{"type", "array"},
          {"minItems", 1},
          {"items", {{"$ref", std::string("#/$defs/") + what}}},
          {"description", description}};
}

}  // namespace

std::string bus_file_schema() {
  Json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"title", "A bus file of ex9000-sim"}};
  schema.update(object_of(run_settings, "lines", list_of("line", "the lines")));
  const Json module =
      object_of(module_settings, "model",
                {{"type", "string"}, {"description", "the model, as --models lists it; EX may be left out"}});
  schema["$defs"] = {
      {"line", object_of(line_settings, "modules", list_of("module", "the modules"))},
      {"module",
       {{"anyOf", {{{"type", "string"}, {"description", "MODEL[@ADDR][,KEY=VALUE]..."}}, module}}}}};
  constexpr int kIndent = 2;
  return schema.dump(kIndent) + "\n";
}

}  // namespace ex9000::sim
