// Tests the conversion of JSON values to YAML.
#include "sim/app/model_exports/yaml.hpp"

#include <gtest/gtest.h>

namespace ex9000::sim {
namespace {

using Ordered = nlohmann::ordered_json;

TEST(Yaml, KeysKeepTheirOrderAndItemsAreIndented) {
  const Ordered hub{
      {"name", "hub"},
      {"items", Ordered::array({Ordered{{"b", 1}, {"a", Ordered{{"c", true}}}}, Ordered{{"d", 0.1}}})}};
  EXPECT_EQ(yaml_of(Ordered::array({hub})),
            "- name: hub\n"
            "  items:\n"
            "    - b: 1\n"
            "      a:\n"
            "        c: true\n"
            "    - d: 0.1\n");
}

TEST(Yaml, ScalarsMayBeItems) {
  EXPECT_EQ(yaml_of(Ordered::array({1, "two words", nullptr, Ordered::array({false})})),
            "- 1\n"
            "- two words\n"
            "- null\n"
            "- - false\n");
}

TEST(Yaml, EmptyValuesAreWrittenExplicitly) {
  EXPECT_EQ(yaml_of(Ordered{{"a", Ordered::object()}, {"b", Ordered::array()}, {"c", ""}}),
            "a: {}\nb: []\nc: \"\"\n");
  EXPECT_EQ(yaml_of(Ordered::object()), "{}\n");
}

TEST(Yaml, AmbiguousStringsAreQuoted) {
  const auto scalar = [](const char* text) { return yaml_of(Ordered(text)); };
  for (const char* word : {"on",   "Off", "YES", "no",  "y",    "N",    "true",      "null", "~",  "12",
                           "0x10", "1e3", "-",   "- a", "a: b", "a #b", "127.0.0.1", "a ",   " a", "*a",
                           "&a",   "!a",  "[a]", "{a}", "%a",   "@a",   "`a`",       "'a'"}) {
    EXPECT_EQ(scalar(word), '"' + std::string(word) + "\"\n");
  }
  EXPECT_EQ(scalar("a\"b\\c\nd"), "\"a\\\"b\\\\c\\nd\"\n");
  for (const char* word : {"EX9042D-M 01 Output 0", "ex9042d_m_01", "s", "once", "yes sir"}) {
    EXPECT_EQ(scalar(word), std::string(word) + "\n");
  }
}

}  // namespace
}  // namespace ex9000::sim
