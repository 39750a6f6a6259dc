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

  /// Reads 13 coils from address 0 on with FC01, from units 1 to `units` in turn, until `end`. Returns the
  /// number of transactions. Throws std::runtime_error if a transfer fails, if the server sends nothing for
  /// 60 s before a reply is complete, or if the unit, the function or the size of a reply is wrong, because a
  /// rate of wrong replies has no meaning.
  std::uint64_t poll_until(std::chrono::steady_clock::time_point end, unsigned units);

 private:
  explicit PollingMaster(int fd) : fd_(fd) {}
  void ask(const std::vector<std::uint8_t>& request, std::uint8_t unit);

  int fd_;
};

}  // namespace ex9000::bench
