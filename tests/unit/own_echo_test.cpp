#include "sim/ports/own_echo.hpp"

#include <gtest/gtest.h>

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

// 9600 baud: a character takes 1.04 ms.
TEST(OwnEcho, CoversWhatWasSentForAsLongAsItTakesOnTheLine) {
  OwnEcho echo(9600);
  const OwnEcho::Clock::time_point start{std::chrono::hours(1)};
  EXPECT_FALSE(echo.covers(start));
  echo.sent(8, start);
  EXPECT_TRUE(echo.covers(start));
  EXPECT_TRUE(echo.covers(start + milliseconds(8)));
  EXPECT_FALSE(echo.covers(start + milliseconds(9)));
}

TEST(OwnEcho, WhatIsSentInPiecesFollowsItself) {
  OwnEcho echo(9600);
  const OwnEcho::Clock::time_point start{std::chrono::hours(1)};
  echo.sent(8, start);
  echo.sent(8, start + milliseconds(1));
  EXPECT_TRUE(echo.covers(start + milliseconds(16)));
  EXPECT_FALSE(echo.covers(start + milliseconds(17)));
}

}  // namespace
}  // namespace ex9000::sim
