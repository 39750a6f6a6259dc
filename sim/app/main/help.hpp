// The texts that --help and the subcommand `help` print.
#pragma once

#include <cstddef>
#include <string>

namespace ex9000::sim::help {

/// Where descriptions begin.
constexpr std::size_t kColumn = 30;

/// Printed after the options.
extern const char* const examples;
/// The steps of transcripts and scenarios.
std::string of_play();

/// For `help`, separated by |.
std::string topics();
std::string on(const std::string& topic);

}  // namespace ex9000::sim::help
