// Runs the simulated lines on several threads.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace ex9000::sim {

/// Runs each line on one of the threads. While the threads run, the main thread may use a line only in the
/// `action` of `pause_for`. Only the main thread may call the public functions of this class.
class LineThreads {
 public:
  /// `main` is the io_context of the main thread, and must outlive this object. If `threads` is less than
  /// two, the lines run on the main thread and use `main`.
  LineThreads(boost::asio::io_context& main, std::size_t threads);
  ~LineThreads() { end(); }
  LineThreads(const LineThreads&) = delete;
  LineThreads& operator=(const LineThreads&) = delete;

  /// Returns the io_context of a line. `line` is the position of the line, from 0.
  [[nodiscard]] boost::asio::io_context& io(std::size_t line);
  /// Starts the threads. An exception in a handler on one of the threads stops `main`. Throws
  /// std::runtime_error with a one-line message if the system cannot start a thread.
  void start();
  /// Waits until the handlers that are running or ready on the threads have ended, then runs `action` while
  /// no handler of a line runs. `action` must not call `pause_for`. Throws what `action` throws.
  void pause_for(const std::function<void()>& action);
  /// Ends the threads. Blocks until the handlers that are running have ended.
  void end();
  /// Throws the first exception that a handler has thrown on one of the threads. Does nothing if there was
  /// none. Call this after `end`.
  void rethrow() const;

 private:
  struct Worker {
    boost::asio::io_context io;
    boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work{io.get_executor()};
    std::thread thread;
  };

  void run(boost::asio::io_context& io);

  boost::asio::io_context& main_;
  std::deque<Worker> workers_;  ///< a deque, because a Worker must not move
  std::mutex mutex_;            ///< protects `failure_`
  std::exception_ptr failure_;
};

}  // namespace ex9000::sim
