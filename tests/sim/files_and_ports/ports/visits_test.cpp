#include "sim/files_and_ports/ports/visits.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/directory.hpp"

namespace ex9000::sim {
namespace {

class VisitsTest : public testing::Test {
 protected:
  VisitsTest() {
    for (const char* name : {"a", "b"}) {
      std::ofstream(directory_ / name).close();
    }
    visits_.watch(directory_ / "a", [this] { ++of_a_; });
    visits_.watch(directory_ / "b", [this] { ++of_b_; });
  }

  void visit(const char* name) { std::ifstream(directory_ / name).close(); }

  system::Directory directory_;
  boost::asio::io_context io_;
  Visits& visits_{boost::asio::use_service<Visits>(io_)};
  int of_a_ = 0;
  int of_b_ = 0;
};

TEST_F(VisitsTest, ReportsOnlyTheDevicesThatWereVisitedIfNoEventIsLost) {
  visit("b");
  visits_.take();
  EXPECT_EQ(of_a_, 0);
  EXPECT_EQ(of_b_, 1);
}

TEST_F(VisitsTest, ReportsEachDeviceOfSeveralEvents) {
  visit("a");
  visit("b");
  visits_.take();
  EXPECT_EQ(of_a_, 1);
  EXPECT_EQ(of_b_, 1);
}

TEST_F(VisitsTest, ReportsAVisitWhoseEventWasLostBecauseTheQueueWasFull) {
  long queued = 0;
  std::ifstream("/proc/sys/fs/inotify/max_queued_events") >> queued;
  ASSERT_GT(queued, 0);
  for (long i = 0; i < queued; ++i) {
    visit("a");
  }
  visit("b");
  visits_.take();
  EXPECT_EQ(of_b_, 1) << "the visit is not reported";
}

}  // namespace
}  // namespace ex9000::sim
