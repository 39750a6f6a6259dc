#include "sim/app/running_program/line_threads.hpp"

#include <boost/asio/post.hpp>
#include <future>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace ex9000::sim {

LineThreads::LineThreads(boost::asio::io_context& main, std::size_t threads) : main_(main) {
  for (std::size_t i = 0; threads > 1 && i < threads; ++i) {
    workers_.emplace_back();
  }
}

boost::asio::io_context& LineThreads::io(std::size_t line) {
  return workers_.empty() ? main_ : workers_[line % workers_.size()].io;
}

void LineThreads::start() {
  std::size_t number = 0;
  for (Worker& worker : workers_) {
    ++number;
    try {
      worker.thread = std::thread([this, &worker] { run(worker.io); });
    } catch (const std::system_error& error) {
      throw std::runtime_error("cannot start thread " + std::to_string(number) + " of " +
                               std::to_string(workers_.size()) + ": " + error.code().message() +
                               "; set a smaller number with --threads");
    }
  }
}

/// Runs the handlers of `io` until `io` is stopped. After an exception the thread continues, because
/// `pause_for` waits for all threads.
void LineThreads::run(boost::asio::io_context& io) {
  while (!io.stopped()) {
    try {
      io.run();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      failure_ = failure_ ? failure_ : std::current_exception();
      main_.stop();
    }
  }
}

void LineThreads::pause_for(const std::function<void()>& action) {
  std::promise<void> pause;  // if `action` throws, the destructor of `pause` ends the pause
  const std::shared_future<void> ended = pause.get_future().share();
  std::vector<std::future<void>> paused;
  for (Worker& worker : workers_) {
    if (worker.thread.joinable()) {
      std::promise<void> begun;
      paused.push_back(begun.get_future());
      boost::asio::post(worker.io, [begun = std::move(begun), ended]() mutable {
        begun.set_value();
        ended.wait();
      });
    }
  }
  for (const std::future<void>& each : paused) {
    each.wait();
  }
  action();
  pause.set_value();
}

void LineThreads::end() {
  for (Worker& worker : workers_) {
    worker.io.stop();
  }
  for (Worker& worker : workers_) {
    if (worker.thread.joinable()) {
      worker.thread.join();
    }
  }
}

void LineThreads::rethrow() const {
  if (failure_) {
    std::rethrow_exception(failure_);
  }
}

}  // namespace ex9000::sim
