// Tests a full line: 32 modules of both protocols receive one request after another. After a reply, the next
// request follows as early as the protocols permit. Each module replies only to its own requests, does not
// treat another module's reply as a request, and keeps receiving. The first module also counts pulses.
//
//     EX9000_VIRTUAL_SECONDS=N    virtual duration at 9600 baud, in seconds; default 60; 86400 is a day.
//                                 At 115200 baud, the duration is N/15 seconds, at most 600.
//     EX9000_SEED=N               seed of the random requests; default 1
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/firmware/neighbours/crowd.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::neighbours {
namespace {

void run(Crowd& crowd, std::chrono::seconds time) {
  const sim::VirtualTime end = crowd.now() + sim::VirtualTime(time);
  while (crowd.now() < end && !testing::Test::HasFatalFailure()) {
    crowd.exchange();
  }
}

void report(const char* what, const Crowd& crowd) {
  const auto [fewest, most] = std::minmax_element(crowd.of_each().begin(), crowd.of_each().end());
  std::printf(
      "%s: %llu replies, %llu of them with a store, %llu broadcasts; %llu to %llu replies from each "
      "module; %llu pulses\n",
      what, static_cast<unsigned long long>(crowd.replies()), static_cast<unsigned long long>(crowd.stores()),
      static_cast<unsigned long long>(crowd.broadcasts()), static_cast<unsigned long long>(*fewest),
      static_cast<unsigned long long>(*most), static_cast<unsigned long long>(crowd.pulses()));
  EXPECT_GT(*fewest, 0U);
  EXPECT_GT(crowd.stores(), crowd.replies() / 20);
  EXPECT_GT(crowd.pulses(), 0U);
}

TEST(Neighbours, AnswerOnlyOwnRequestsAt9600BaudWhileOneCounts250PulsesPerSecond) {
  Crowd crowd(9600, number_in_environment("EX9000_SEED", 1));
  crowd.pulser().start(250);
  run(crowd, std::chrono::seconds(number_in_environment("EX9000_VIRTUAL_SECONDS", 60)));
  crowd.pulser().stop();
  report("9600 baud", crowd);
  for (std::size_t i = 0; i < Crowd::kModules; ++i) {
    EXPECT_EQ(crowd.ever_on()[i] != 0, crowd.outputs_of(i) != 0) << "module " << i + 1;
  }
}

TEST(Neighbours, AnswerOnlyOwnRequestsAt115200BaudWhileOneCounts30000PulsesPerSecond) {
  Crowd crowd(115200, number_in_environment("EX9000_SEED", 1));
  crowd.pulser().start(30'000);
  run(crowd, std::chrono::seconds(
                 std::min<std::uint64_t>(number_in_environment("EX9000_VIRTUAL_SECONDS", 60) / 15, 600)));
  crowd.pulser().stop();
  report("115200 baud", crowd);
}

}  // namespace
}  // namespace ex9000::neighbours
