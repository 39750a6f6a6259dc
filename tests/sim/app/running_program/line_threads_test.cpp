// Tests the threads of the lines: their start, the distribution of the lines, pauses, and exceptions.
#include "sim/app/running_program/line_threads.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <boost/asio/post.hpp>
#include <functional>
#include <iostream>
#include <set>
#include <stdexcept>
#include <thread>

namespace ex9000::sim {
namespace {

using boost::asio::io_context;

TEST(LineThreads, WithOneThreadAllLinesRunOnTheMainThread) {
  io_context main;
  LineThreads threads(main, 1);
  EXPECT_EQ(&threads.io(0), &main);
  EXPECT_EQ(&threads.io(7), &main);
  bool ran = false;
  threads.start();
  threads.pause_for([&ran] { ran = true; });
  EXPECT_TRUE(ran);
}

TEST(LineThreads, LinesAreDistributedOverTheThreads) {
  io_context main;
  LineThreads threads(main, 3);
  std::set<io_context*> used;
  for (std::size_t line = 0; line < 6; ++line) {
    used.insert(&threads.io(line));
    EXPECT_EQ(&threads.io(line), &threads.io(line + 3));
  }
  EXPECT_EQ(used.size(), 3U);
  EXPECT_EQ(used.count(&main), 0U);
}

/// Increments `count` again and again on the thread that runs `io`.
void keep_counting(io_context& io, std::atomic<int>& count) {
  boost::asio::post(io, [&io, &count] {
    ++count;
    keep_counting(io, count);
  });
}

TEST(LineThreads, NoHandlerOfALineRunsDuringAPause) {
  io_context main;
  std::atomic<int> counts[2]{};
  LineThreads threads(main, 2);
  keep_counting(threads.io(0), counts[0]);
  keep_counting(threads.io(1), counts[1]);
  threads.start();
  for (int pause = 0; pause < 20; ++pause) {
    threads.pause_for([&counts] {
      const int before[2]{counts[0], counts[1]};
      for (int i = 0; i < 100; ++i) {
        std::this_thread::yield();
      }
      EXPECT_EQ(counts[0], before[0]);
      EXPECT_EQ(counts[1], before[1]);
    });
    for (const int before = counts[1]; counts[1] == before;) {
      std::this_thread::yield();  // waits until a handler runs after the pause
    }
  }
  threads.end();
  const int after = counts[0];
  threads.pause_for([] {});  // does not wait, because no thread runs
  EXPECT_EQ(counts[0], after);
}

/// Starts threads as a user who may start no more processes and threads, prints why the start fails, and
/// ends the process.
void start_without_permission() {
  constexpr uid_t kNobody = 65534;
  const rlimit none{0, 0};
  io_context main;
  LineThreads threads(main, 2);
  if ((geteuid() != 0 || setuid(kNobody) == 0) && setrlimit(RLIMIT_NPROC, &none) == 0) {
    try {
      threads.start();
    } catch (const std::runtime_error& error) {
      std::cerr << error.what() << '\n';
    }
  }
  _exit(0);
}

TEST(LineThreadsDeathTest, AThreadThatCannotStartIsReported) {
  EXPECT_EXIT(start_without_permission(), testing::ExitedWithCode(0),
              "^cannot start thread 1 of 2: Resource temporarily unavailable; set a smaller number with "
              "--threads\n$");
}

TEST(LineThreads, AnExceptionOfAnActionEndsThePauseAndReachesTheCaller) {
  io_context main;
  std::atomic<int> count{0};
  LineThreads threads(main, 2);
  keep_counting(threads.io(0), count);
  threads.start();
  EXPECT_THROW(threads.pause_for([] { throw std::runtime_error("action"); }), std::runtime_error);
  for (const int before = count; count == before;) {
    std::this_thread::yield();
  }
}

TEST(LineThreads, AnExceptionOfAHandlerStopsTheMainLoopAndIsRethrown) {
  io_context main;
  const auto work = boost::asio::make_work_guard(main);
  LineThreads threads(main, 2);
  boost::asio::post(threads.io(1), [] { throw std::runtime_error("the port has disappeared"); });
  threads.start();
  main.run();  // ends because the handler has thrown
  bool paused = false;
  threads.pause_for([&paused] { paused = true; });
  EXPECT_TRUE(paused);
  threads.end();
  try {
    threads.rethrow();
    FAIL() << "no exception";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "the port has disappeared");
  }
}

}  // namespace
}  // namespace ex9000::sim
