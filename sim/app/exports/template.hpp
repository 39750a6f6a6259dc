// Fills in the templates of exports.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace ex9000::sim {

/// The syntax is a part of that of Mustache, plus what is marked with +:
///
///     {{name}}                a value of the innermost object that has this member; {{name.member}}
///     {{.}}                   the innermost value
///     {{#name}}...{{/name}}   once for each element of a list. Another value: once, unless it is false,
///                             null, 0 or an empty object
///     {{^name}}...{{/name}}   once if {{#name}} would print nothing
///     {{! text }}             a comment, in one line
///   + {{#name=a|b}}...{{/name}}, {{^name=a|b}}...{{/name}}   whether the value is one of these texts
///   + {{#more}}               true if another element of the list follows
///   + {{name|hex2}}, {{name|hex4}}, {{name*40}}, {{name-1}}   the number in hex, and arithmetic
///
/// Nothing is escaped. Tags of sections and comments alone in a line leave no line. Throws std::logic_error
/// if the template is wrong, for example uses a name that `data` lacks.
std::string filled_in(std::string_view text, const nlohmann::ordered_json& data);

}  // namespace ex9000::sim
