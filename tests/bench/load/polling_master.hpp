// A master that sends its next request as soon as the server has replied.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::bench {

/// Reads and writes raw bytes on a descriptor, so that it measures only the server and no master library.
class PollingMaster {
 public:
  /// These functions throw std::runtime_error if the connection fails.
  static PollingMaster over_tcp(std::uint16_t port);
  static PollingMaster over_tty(const std::string& path);
  /// Creates a pseudo-terminal and uses its master end. Stores the path of the other end, which a server can
  /// open, in `path`.
  static PollingMaster over_new_tty(std::string& path);
  PollingMaster(PollingMaster&& other) noexcept;
  PollingMaster(const PollingMaster&) = delete;
  PollingMaster& operator=(const PollingMaster&) = delete;
  ~PollingMaster();

  /// Reads 13 coils from address 0 with FC01 from units 1 to `units` in turn, until `end`. Returns the number
  /// of transactions. Throws std::runtime_error at the first wrong or missing reply, because a rate of wrong
  /// replies has no meaning.
  std::uint64_t poll_until(std::chrono::steady_clock::time_point end, unsigned units);

 private:
  explicit PollingMaster(int fd) : fd_(fd) {}
  void ask(const std::vector<std::uint8_t>& request, std::uint8_t unit);

  int fd_;
};

}  // namespace ex9000::bench
