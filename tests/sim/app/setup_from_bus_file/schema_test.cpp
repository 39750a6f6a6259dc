// Tests that the JSON Schema of bus files has exactly the keys of the reader, each with its meaning. Also
// tests which keys the schema requires.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "sim/app/setup_from_bus_file/bus_file.hpp"
#include "sim/app/setup_from_bus_file/keys.hpp"

namespace ex9000::sim {
namespace {

using json = nlohmann::json;

/// Expects that `object`, the schema of a JSON object, has exactly `keys`, each with its schema and its
/// meaning.
template <class Keys>
void expect_keys(const json& object, const Keys& keys) {
  EXPECT_EQ(object.at("type"), "object");
  EXPECT_EQ(object.at("additionalProperties"), false);
  EXPECT_EQ(object.at("properties").size(), keys.size());
  for (const auto& key : keys) {
    SCOPED_TRACE(key.name);
    ASSERT_TRUE(object.at("properties").contains(key.name));
    EXPECT_FALSE(key.meaning.empty());
    EXPECT_EQ(key.meaning.find('|'), std::string::npos)
        << "leave out '|', because it would end a cell of the table in bus-files.md";
    json property = json::parse(key.schema);
    EXPECT_TRUE(property.is_object());
    property["description"] = key.meaning;
    EXPECT_EQ(object.at("properties").at(std::string(key.name)), property);
  }
}

TEST(BusFileSchema, HasExactlyTheKeysOfTheReader) {
  const json schema = json::parse(bus_file_schema());
  EXPECT_EQ(schema.at("$schema"), "https://json-schema.org/draft/2020-12/schema");
  expect_keys(schema, bus_keys);
  expect_keys(schema.at("$defs").at("line"), line_keys);
  expect_keys(schema.at("$defs").at("module"), module_keys);
}

TEST(BusFileSchema, RequiresLinesModulesAndModel) {
  const json schema = json::parse(bus_file_schema());
  EXPECT_EQ(schema.at("required"), json::array({"lines"}));
  EXPECT_EQ(schema.at("$defs").at("line").at("required"), json::array({"modules"}));
  EXPECT_EQ(schema.at("$defs").at("module").at("required"), json::array({"model"}));
}

}  // namespace
}  // namespace ex9000::sim
