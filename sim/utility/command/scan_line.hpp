// `ex9000 scan`: which modules are on a line.
#pragma once

#include <vector>

#include "sim/utility/command/verb.hpp"
#include "sim/utility/scan/scan.hpp"

namespace ex9000::utility {

/// In all modes that the options leave.
Search search_of(MasterLine& line, const Options& options);
/// Prints each module as soon as it is found, and at the end which addresses are there twice.
std::vector<FoundModule> print_modules(Environment& environment, MasterLine& line, const Search& search,
                                       bool json);

bool scan_line(Environment& environment, const sim::Words& args, const Options& options);

}  // namespace ex9000::utility
