// Reports when masters open or close pseudo-terminals.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>
#include <map>
#include <string>

namespace ex9000::sim {

/// A service of an io_context (boost::asio::use_service): all its pseudo-terminals share one inotify
/// instance, because Debian lets a user have only 128 by default. Never blocks.
class Visits final : public boost::asio::io_context::service {
 public:
  static boost::asio::io_context::id id;

  explicit Visits(boost::asio::io_context& io);

  /// `visited` is called, from the io_context or `take`, after a process has opened or closed `device`.
  /// Returns the number of the watch. std::runtime_error: the system cannot watch the device.
  int watch(const std::string& device, std::function<void()> visited);
  void ignore(int watch);
  /// Reads the kernel's events now. Calls all functions if its queue was full (fs.inotify.max_queued_events).
  void take();

 private:
  void shutdown() override;
  void wait();

  boost::asio::posix::stream_descriptor inotify_;  ///< opened for the first watch
  std::map<int, std::function<void()>> watches_;
  std::array<char, 4096> events_{};  ///< a member, so that it is filled with zeros only once
};

}  // namespace ex9000::sim
