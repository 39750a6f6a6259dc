#include "sim/files_and_ports/ports/own_echo.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

const OwnEcho::Clock::time_point kStart{std::chrono::hours(1)};

class Adapter {
 public:
  void sends(const std::vector<std::uint8_t>& bytes, milliseconds at) {
    echo_.sent({bytes.data(), bytes.size()}, kStart + at);
  }
  std::size_t echo_in(const std::vector<std::uint8_t>& heard, milliseconds at) {
    return echo_.in({heard.data(), heard.size()}, kStart + at);
  }

 private:
  OwnEcho echo_{hal::SerialMode{9600}};
};

TEST(OwnEcho, SentBytesAreRecognizedOnceInTheReceivedBytes) {
  Adapter adapter;
  EXPECT_EQ(adapter.echo_in({1, 2, 3}, milliseconds(0)), 0U);
  adapter.sends({1, 2, 3}, milliseconds(0));
  EXPECT_EQ(adapter.echo_in({1, 2, 3}, milliseconds(5)), 3U);
  EXPECT_EQ(adapter.echo_in({1, 2, 3}, milliseconds(6)), 0U);
}

TEST(OwnEcho, MayArriveLateAndInPieces) {
  Adapter adapter;
  adapter.sends({1, 2}, milliseconds(0));
  adapter.sends({3, 4}, milliseconds(1));
  EXPECT_EQ(adapter.echo_in({1}, milliseconds(20)), 1U);
  EXPECT_EQ(adapter.echo_in({2, 3}, milliseconds(40)), 2U);
  EXPECT_EQ(adapter.echo_in({4, 9, 9}, milliseconds(60)), 1U);
}

TEST(OwnEcho, IsRecognizedIfABusyHostReadsItLate) {
  Adapter adapter;
  adapter.sends({1, 2, 3}, milliseconds(0));
  EXPECT_EQ(adapter.echo_in({1, 2, 3}, milliseconds(10'000)), 3U);
}

TEST(OwnEcho, AByteThatDiffersFromTheSentOneEndsTheEcho) {
  Adapter adapter;
  adapter.sends({1, 2, 3}, milliseconds(0));
  EXPECT_EQ(adapter.echo_in({1, 9}, milliseconds(5)), 1U);
  EXPECT_EQ(adapter.echo_in({2, 3}, milliseconds(6)), 0U);
}

TEST(OwnEcho, IsNotExpectedAfterATimeout) {
  Adapter adapter;
  adapter.sends({1, 2, 3}, milliseconds(0));
  EXPECT_EQ(adapter.echo_in({1, 2, 3}, milliseconds(10'100)), 0U);
}

}  // namespace
}  // namespace ex9000::sim
