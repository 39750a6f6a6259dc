// Both ends of a UNIX socket, for a program that is told where to connect to.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::rig {

/// How long the host waits for an emulator that owes it a reply. It only detects a hang: a reply takes
/// milliseconds, on a busy machine seconds.
inline constexpr std::chrono::seconds kHang{60};

/// A connection. Whatever goes wrong throws std::runtime_error.
class UnixSocket {
 public:
  explicit UnixSocket(int fd) : fd_(fd) {}
  ~UnixSocket();
  UnixSocket(UnixSocket&& other) noexcept;
  UnixSocket& operator=(UnixSocket&&) = delete;

  [[nodiscard]] int fd() const { return fd_; }
  /// In one piece, as far as the kernel takes it; blocks until it has taken all.
  void send(const std::uint8_t* bytes, std::size_t size);
  void send(const std::string& text);
  /// What is there, once there is something; nothing where nothing came for `patience`.
  std::vector<std::uint8_t> receive(std::chrono::nanoseconds patience);
  /// So many bytes. Throws if nothing comes for `kHang`.
  void receive_all(std::uint8_t* bytes, std::size_t size);
  /// Whether something is there.
  [[nodiscard]] bool has_bytes() const;
  /// Up to LF, which is left out. Throws if nothing comes for `kHang`.
  std::string receive_line();

 private:
  int fd_;
  std::string received_;  ///< behind the last line
};

/// Waits until one of them has bytes; false if none has for `kHang`.
bool wait_for_any(const std::vector<const UnixSocket*>& sockets);

/// Where one program will connect to.
class UnixListener {
 public:
  explicit UnixListener(const std::string& path);
  ~UnixListener();
  UnixListener(const UnixListener&) = delete;
  UnixListener& operator=(const UnixListener&) = delete;

  /// Throws std::runtime_error if nobody connects for `kHang`.
  UnixSocket accept();

 private:
  int fd_;
};

}  // namespace ex9000::rig
