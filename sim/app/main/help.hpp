// The texts that --help and the subcommand `help` print.
#pragma once

#include <cstddef>
#include <string>

namespace ex9000::sim::help {

/// The column at which descriptions begin.
constexpr std::size_t kColumn = 30;

/// Printed after the options.
extern const char* const examples;
/// The steps of transcripts and scenarios.
std::string of_play();

/// The topics of `help`, separated by |.
std::string topics();
/// Throws std::invalid_argument with a one-line message if there is no such topic.
std::string on(const std::string& topic);

}  // namespace ex9000::sim::help
