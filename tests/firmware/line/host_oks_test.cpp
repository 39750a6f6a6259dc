// Tests how interrupts pass the times of host OKs to the main loop.
#include "firmware/line/host_oks.hpp"

#include <gtest/gtest.h>

namespace ex9000 {
namespace {

TEST(HostOks, NoHostOkIsWaitingAtFirst) {
  const HostOks host_oks;
  EXPECT_FALSE(host_oks.waiting());
}

TEST(HostOks, AHostOkWaitsUntilItIsTaken) {
  HostOks host_oks;
  host_oks.add_in_interrupt(Time(5));
  ASSERT_TRUE(host_oks.waiting());
  const HostOks::Times times = host_oks.take_in_main_loop();
  EXPECT_EQ(times.first.microseconds(), 5U);
  EXPECT_EQ(times.last.microseconds(), 5U);
  EXPECT_FALSE(host_oks.waiting());
}

TEST(HostOks, TheTimesOfTheFirstAndTheLastOfSeveralHostOksAreTaken) {
  HostOks host_oks;
  for (const std::uint32_t time : {5U, 6U, 7U}) {
    host_oks.add_in_interrupt(Time(time));
  }
  const HostOks::Times times = host_oks.take_in_main_loop();
  EXPECT_EQ(times.first.microseconds(), 5U);
  EXPECT_EQ(times.last.microseconds(), 7U);
}

TEST(HostOks, IfOneHostOkArrivesAfterTheTimesWereTakenItIsBothTheFirstAndTheLast) {
  HostOks host_oks;
  host_oks.add_in_interrupt(Time(5));
  host_oks.take_in_main_loop();
  host_oks.add_in_interrupt(Time(8));
  ASSERT_TRUE(host_oks.waiting());
  const HostOks::Times times = host_oks.take_in_main_loop();
  EXPECT_EQ(times.first.microseconds(), 8U);
  EXPECT_EQ(times.last.microseconds(), 8U);
}

}  // namespace
}  // namespace ex9000
