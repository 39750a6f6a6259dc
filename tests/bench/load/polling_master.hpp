// A master that asks the same again and again, as fast as it is answered.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::bench {

/// Raw bytes on a descriptor; whoever serves is measured, and not a library.
class PollingMaster {
 public:
  /// Throw std::runtime_error where there is nobody.
  static PollingMaster over_tcp(std::uint16_t port);
  static PollingMaster over_tty(const std::string& path);
  /// Makes a pseudo-terminal and has its master end; `path` becomes that of the other, for a server.
  static PollingMaster over_new_tty(std::string& path);
  PollingMaster(PollingMaster&& other) noexcept;
  PollingMaster(const PollingMaster&) = delete;
  PollingMaster& operator=(const PollingMaster&) = delete;
  ~PollingMaster();

  /// Transactions of FC01, 13 coils from 0, with `units` in turn, until `end`. Throws std::runtime_error at
  /// the first answer that is not one: nobody is fast who is wrong.
  std::uint64_t poll_until(std::chrono::steady_clock::time_point end, unsigned units);

 private:
  explicit PollingMaster(int fd) : fd_(fd) {}
  void ask(const std::vector<std::uint8_t>& request, std::uint8_t unit);

  int fd_;
};

}  // namespace ex9000::bench
