// Tests how templates are filled in. Without the marks in template.hpp, the expected texts are those of the
// specification of Mustache.
#include "sim/app/exports/template.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>

namespace ex9000::sim {
namespace {

using Json = nlohmann::ordered_json;

/// Fills in a template of one line.
std::string line_of(const std::string& text, const Json& data) {
  const std::string line = filled_in(text, data);
  EXPECT_EQ(line.back(), '\n');
  return line.substr(0, line.size() - 1);
}

TEST(Template, PrintsTextsNumbersAndMembersOfObjects) {
  EXPECT_EQ(line_of("{{text}} {{number}} {{none}} {{object.member}}",
                    {{"text", "a <b>"}, {"number", 7}, {"none", nullptr}, {"object", {{"member", "c"}}}}),
            "a <b> 7  c");
}

TEST(Template, ASectionIsPrintedForEachElement) {
  EXPECT_EQ(line_of("{{#list}}{{name}}{{outer}}, {{/list}}.",
                    {{"outer", 1}, {"list", Json::array({{{"name", "a"}}, {{"name", "b"}}})}}),
            "a1, b1, .");
  EXPECT_EQ(line_of("{{#list}}{{.}}{{#more}}+{{/more}}{{^more}}!{{/more}}{{/list}}", {{"list", {1, 2, 3}}}),
            "1+2+3!");
}

TEST(Template, MoreConcernsTheInnermostList) {
  const Json data{
      {"outer", Json::array({{{"inner", {1, 2}}, {"yes", true}}, {{"inner", {3}}, {"yes", true}}})}};
  EXPECT_EQ(line_of("{{#outer}}{{#inner}}{{.}}{{#more}},{{/more}}{{/inner}}{{#yes}}{{#more}};{{/more}}{{/"
                    "yes}}{{/outer}}",
                    data),
            "1,2;3");
}

TEST(Template, FalseAndEmptyValuesPrintOnlyInvertedSections) {
  for (const Json& empty : {Json(false), Json(nullptr), Json(0), Json::array(), Json::object()}) {
    EXPECT_EQ(line_of("{{#a}}yes{{/a}}{{^a}}no{{/a}}", {{"a", empty}}), "no") << empty;
  }
  for (const Json& value : {Json(true), Json(1), Json("x"), Json::array({0}), Json{{"b", 0}}}) {
    EXPECT_EQ(line_of("{{#a}}yes{{/a}}{{^a}}no{{/a}}", {{"a", value}}), "yes") << value;
  }
}

TEST(Template, ComparesAndCalculates) {
  const char* const text = "{{#role=input|state}}1{{/role}}{{^role=output}}2{{/role}}{{#role=put}}3{{/role}}";
  EXPECT_EQ(line_of(text, {{"role", "input"}}), "12");
  EXPECT_EQ(line_of("{{n|hex2}} {{n|hex4}} {{n*40}} {{n-1}}", {{"n", 10}}), "0A 000A 400 9");
}

TEST(Template, LinesOfTagsLeaveNoLine) {
  const char* const text =
      "begin\n{{! a comment }}\n  {{#a}}\n  {{.}}\n  {{/a}}\n\n{{^a}}\nnone\n{{/a}}\nend\n";
  EXPECT_EQ(filled_in(text, {{"a", {1, 2}}}), "begin\n  1\n  2\n\nend\n");
  EXPECT_EQ(filled_in(text, {{"a", Json::array()}}), "begin\n\nnone\nend\n");
}

TEST(Template, AWrongTemplateIsRejectedWithItsTag) {
  const std::pair<const char*, const char*> wrong[] = {
      {"{{b}}", "{{b}}: there is no such name"},   {"{{#b}}{{/b}}", "{{b}}: there is no such name"},
      {"{{#a}}", "{{a}}: the section has no end"}, {"{{#a}}{{/b}}", "{{/b}}: ends another section"},
      {"{{/a}}", "{{/a}}: ends another section"},  {"{{a", "{{a}}: is not closed"},
  };
  for (const auto& [text, message] : wrong) {
    try {
      filled_in(text, {{"a", Json::object()}});
      ADD_FAILURE() << text << " is accepted";
    } catch (const std::logic_error& error) {
      EXPECT_STREQ(error.what(), message);
    }
  }
}

}  // namespace
}  // namespace ex9000::sim
