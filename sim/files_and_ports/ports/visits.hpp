// Reports when masters open or close pseudo-terminals.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <functional>
#include <map>
#include <string>

namespace ex9000::sim {

/// A service of an io_context, so that all pseudo-terminals of the io_context share one inotify instance: by
/// default, a user may have only 128 inotify instances on Debian. Call boost::asio::use_service to get the
/// service. None of the functions blocks.
class Visits final : public boost::asio::io_context::service {
 public:
  static boost::asio::io_context::id id;

  /// Called by boost::asio::use_service.
  explicit Visits(boost::asio::io_context& io);

  /// Starts to watch `device`: after a process has opened or closed it, `visited` is called while the
  /// io_context runs, or by `take`. Returns the number of the watch. Throws std::runtime_error with a
  /// one-line message if the system cannot watch the device.
  int watch(const std::string& device, std::function<void()> visited);
  /// Ends a watch. Its function is not called any more.
  void ignore(int watch);
  /// Reads the kernel's events. Calls `visited` of each watched device that a process has opened or closed.
  /// If the system has lost events because its queue was full (fs.inotify.max_queued_events), calls `visited`
  /// of all watched devices.
  void take();

 private:
  void shutdown() override;
  void wait();

  boost::asio::posix::stream_descriptor inotify_;  ///< opened for the first watch
  std::map<int, std::function<void()>> watches_;
  std::array<char, 4096> events_{};  ///< a member, so that it is filled with zeros only once
};

}  // namespace ex9000::sim
