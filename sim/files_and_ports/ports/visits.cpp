#include "sim/files_and_ports/ports/visits.hpp"

#include <sys/inotify.h>
#include <unistd.h>

#include <cstring>
#include <set>
#include <stdexcept>
#include <utility>

#include "sim/text/system_error.hpp"

namespace ex9000::sim {

boost::asio::io_context::id Visits::id;

Visits::Visits(boost::asio::io_context& io) : boost::asio::io_context::service(io), inotify_(io) {}

void Visits::shutdown() {
  boost::system::error_code ignored;
  inotify_.close(ignored);
}

int Visits::watch(const std::string& device, std::function<void()> visited) {
  if (!inotify_.is_open()) {
    const int fd = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (fd < 0) {
      throw std::runtime_error("cannot watch " + device + ": " + reason() +
                               "; end other simulators or raise fs.inotify.max_user_instances");
    }
    inotify_.assign(fd);
    wait();
  }
  const int watch = inotify_add_watch(inotify_.native_handle(), device.c_str(), IN_OPEN | IN_CLOSE);
  if (watch < 0) {
    throw std::runtime_error("cannot watch " + device + ": " + reason() +
                             "; use fewer pseudo-terminals or raise fs.inotify.max_user_watches");
  }
  watches_[watch] = std::move(visited);
  return watch;
}

void Visits::ignore(int watch) {
  watches_.erase(watch);
  if (inotify_.is_open()) {
    inotify_rm_watch(inotify_.native_handle(), watch);
  }
}

void Visits::wait() {
  inotify_.async_wait(boost::asio::posix::stream_descriptor::wait_read,
                      [this](const boost::system::error_code& error) {
                        if (!error) {
                          take();
                          wait();
                        }
                      });
}

/// One call for each device, whatever the number of events: the kernel merges identical ones. After an
/// overflow of its queue, events of any device may be lost, so calls the functions of all.
void Visits::take() {
  std::set<int> visited;
  for (ssize_t size = 0; (size = read(inotify_.native_handle(), events_.data(), events_.size())) > 0;) {
    for (std::size_t at = 0; at < static_cast<std::size_t>(size);) {
      inotify_event event{};
      std::memcpy(&event, events_.data() + at, sizeof event);
      at += sizeof event + event.len;
      if ((event.mask & IN_Q_OVERFLOW) != 0) {
        for (const auto& each : watches_) {
          visited.insert(each.first);
        }
      }
      visited.insert(event.wd);
    }
  }
  for (const int watch : visited) {
    if (const auto watched = watches_.find(watch); watched != watches_.end()) {
      watched->second();
    }
  }
}

}  // namespace ex9000::sim
