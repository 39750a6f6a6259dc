// Parses a command line of ex9000-sim, and checks the error message of a wrong command line.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/app/main/arguments.hpp"

namespace ex9000::sim {

inline Parsed parse(const std::vector<const char*>& words) {
  std::vector<const char*> argv{"ex9000-sim"};
  argv.insert(argv.end(), words.begin(), words.end());
  return parse_arguments(static_cast<int>(argv.size()), argv.data());
}

/// Expects that the program rejects `words`. The error message must be one line that contains `wrong` and
/// `mend`, and begins with the name of the program.
inline void expect_error(const std::vector<const char*>& words, const std::string& wrong,
                         const std::string& mend) {
  const Parsed parsed = parse(words);
  ASSERT_FALSE(parsed.error.empty());
  EXPECT_FALSE(parsed.setup);
  EXPECT_EQ(parsed.output, "");
  EXPECT_NE(parsed.exit_status, 0);
  EXPECT_EQ(parsed.error.find("ex9000-sim: "), 0U) << parsed.error;
  EXPECT_NE(parsed.error.find(wrong), std::string::npos) << parsed.error;
  EXPECT_NE(parsed.error.find(mend), std::string::npos) << parsed.error;
  EXPECT_EQ(std::count(parsed.error.begin(), parsed.error.end(), '\n'), 1) << parsed.error;
  EXPECT_EQ(parsed.error.back(), '\n');
}

}  // namespace ex9000::sim
