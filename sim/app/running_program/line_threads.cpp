#include "sim/app/running_program/line_threads.hpp"

#include <boost/asio/post.hpp>
#include <stdexcept>
#include <string>
#include <system_error>

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
  for (Worker& worker : workers_) {
    try {
      worker.thread = std::thread([this, &worker] { run(worker.io); });
    } catch (const std::system_error& error) {
      throw std::runtime_error("cannot start thread " + std::to_string(running_ + 1) + " of " +
                               std::to_string(workers_.size()) + ": " + error.code().message() +
                               "; use fewer with --threads");
    }
    ++running_;
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

void LineThreads::pause() {
  std::unique_lock<std::mutex> lock(mutex_);
  ++paused_;
  changed_.notify_all();
  changed_.wait(lock, [this, pause = pauses_] { return pauses_ != pause; });
}

void LineThreads::resume() {
  const std::lock_guard<std::mutex> lock(mutex_);
  paused_ = 0;
  ++pauses_;
  changed_.notify_all();
}

void LineThreads::pause_for(const std::function<void()>& action) {
  if (running_ != 0) {
    for (Worker& worker : workers_) {
      boost::asio::post(worker.io, [this] { pause(); });
    }
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return paused_ == running_; });
  }
  try {
    action();
  } catch (...) {
    resume();
    throw;
  }
  resume();
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
  running_ = 0;
}

void LineThreads::rethrow() const {
  if (failure_) {
    std::rethrow_exception(failure_);
  }
}

}  // namespace ex9000::sim
