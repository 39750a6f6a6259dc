// Tests the parsing of durations that people write, and the text of durations that the program writes.
#include "sim/text/durations.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

TEST(TimeText, HasANumberAndAUnit) {
  EXPECT_EQ(parse_time("12.5s"), 12'500ms);
  EXPECT_EQ(parse_time("50ms"), 50ms);
  EXPECT_EQ(parse_time("300us"), 300us);
  EXPECT_EQ(parse_time("2min"), 2min);
  EXPECT_EQ(parse_time("24h"), 24h);
  EXPECT_EQ(parse_time("0s"), 0ns);
  EXPECT_EQ(parse_time("0.5us"), 500ns);
  EXPECT_EQ(parse_time("8760h"), 8760h);
}

TEST(TimeText, IsExactToTheNanosecond) {
  EXPECT_EQ(parse_time("0.1s"), 100ms);
  EXPECT_EQ(parse_time("1.000000001s"), 1s + 1ns);
  EXPECT_EQ(parse_time("0.001us"), 1ns);
}

TEST(TimeText, OtherTextIsRefusedWithExamplesInTheMessage) {
  for (const char* text :
       {"",    "s",   "5",    "5 s",    " 5s",   "5s ",  "5S",   "5sec",  "5m",     "5ns",
        "-1s", "+1s", "1e3s", "1.2.3s", "0x10s", "infs", "nans", "8761h", "1e999s", "99999999999999999999h",
        "5s5"}) {
    EXPECT_EQ(refusal([&] { parse_time(text); }),
              "'" + std::string(text) +
                  "': expected a duration up to a year, for example 300us, 50ms, 12.5s, 2min or 24h");
  }
}

TEST(TimeText, IsReadBackAsTheSameTime) {
  EXPECT_EQ(time_text(12'500ms), "12.5s");
  EXPECT_EQ(time_text(100ms), "100ms");
  EXPECT_EQ(time_text(10us), "10us");
  EXPECT_EQ(time_text(24h), "86400s");
  EXPECT_EQ(time_text(8'930'442'872'724'057ns), "8930442.872724057s");
  for (const hal::doubles::VirtualTime time :
       {0ns, 1ns, 1'000ns, 999'999ns, 100'000'001ns, 3'600'000'001'000ns, 8'930'442'872'724'057ns,
        31'535'999'999'999'999ns}) {
    EXPECT_EQ(parse_time(time_text(time)), time) << time_text(time);
  }
}

}  // namespace
}  // namespace ex9000::sim
