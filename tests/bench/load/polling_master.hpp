// A master that sends its next request immediately after the reply of the server.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::bench {

/// Reads and writes raw bytes on a descriptor. Therefore a measurement includes no master library.
class PollingMaster {
 public:
  /// The functions `over_...` throw std::runtime_error if they cannot open the connection.
  static PollingMaster over_tcp(std::uint16_t port);
  static PollingMaster over_tty(const std::string& path);
  /// Creates a pseudo-terminal and uses its master end. Stores the path of the other end in `path`, so
  /// that a server can open it.
  static PollingMaster over_new_tty(std::string& path);
  PollingMaster(PollingMaster&& other) noexcept;
  PollingMaster(const PollingMaster&) = delete;
  PollingMaster& operator=(const PollingMaster&) = delete;
  ~PollingMaster();

  /// Polls units 1 to `units` in turn until `end`. Each request reads coils 0 to 12 with FC01. Returns the
  /// number of transactions. Throws std::runtime_error if a transfer fails, or if the server sends nothing
  /// for 60 s before a reply is complete. A rate of wrong replies has no meaning. Therefore this function
  /// also throws std::runtime_error if the unit, the function or the size in a reply is wrong.
  std::uint64_t poll_until(std::chrono::steady_clock::time_point end, unsigned units);

 private:
  explicit PollingMaster(int fd) : fd_(fd) {}
  void ask(const std::vector<std::uint8_t>& request, std::uint8_t unit);

  int fd_;
};

}  // namespace ex9000::bench
