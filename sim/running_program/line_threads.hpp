// The threads that the lines of a program run on.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace ex9000::sim {

/// Each line runs on one of the threads, and the lines share nothing. The main thread can use a line only
/// during a pause. All functions are for the main thread.
class LineThreads {
 public:
  /// With fewer than two threads, the lines run in `main` too. `main` must outlive this object.
  LineThreads(boost::asio::io_context& main, std::size_t threads);
  ~LineThreads() { end(); }
  LineThreads(const LineThreads&) = delete;
  LineThreads& operator=(const LineThreads&) = delete;

  /// Returns the io_context of a line. `line` is its position, from 0.
  [[nodiscard]] boost::asio::io_context& io(std::size_t line);
  /// Starts the threads. If a handler of a line throws, `main` is stopped. Throws std::runtime_error with a
  /// one-line message if the system cannot start a thread.
  void start();
  /// Runs `action` while no handler of a line runs. Blocks until the present handlers have ended.
  void pause_for(const std::function<void()>& action);
  /// Ends the threads. Blocks until the present handlers have ended.
  void end();
  /// Throws the first exception that a handler of a line has thrown. Call this after `end`.
  void rethrow() const;

 private:
  struct Worker {
    boost::asio::io_context io;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
    std::thread thread;
  };

  void run(boost::asio::io_context& io);
  void pause();
  void resume();

  boost::asio::io_context& main_;
  std::deque<Worker> workers_;  ///< a deque, because a Worker must not move
  std::size_t running_ = 0;     ///< number of started threads
  std::mutex mutex_;            ///< protects the members below
  std::condition_variable changed_;
  std::size_t paused_ = 0;    ///< number of threads in the present pause
  std::uint64_t pauses_ = 0;  ///< number of pauses that have ended
  std::exception_ptr failure_;
};

}  // namespace ex9000::sim
