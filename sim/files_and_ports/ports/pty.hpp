// A pseudo-terminal with a link to it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/ports/claim.hpp"

namespace ex9000::sim {

/// Owns the simulator's end. Masters open and close the other end (the slave), which keeps its settings while
/// no master has it open. The constructor sets the terminal to raw mode.
class Pty {
 public:
  /// Creates a pseudo-terminal set to `baud` and a symbolic link to its slave at `link`. Replaces a link to a
  /// pseudo-terminal that no running simulator uses. Throws std::invalid_argument with a one-line message if
  /// anything else exists at `link`, another simulator uses the path, or the path cannot be created, and
  /// std::runtime_error if the system cannot create or set up a pseudo-terminal. After an exception, neither
  /// the link nor the pseudo-terminal remains.
  Pty(std::string link, std::uint32_t baud);
  /// Removes the link if it still leads to this object's slave.
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  /// Returns the simulator's end for reading; non-blocking. Reading fails if no master has the
  /// slave open and all bytes have been read.
  [[nodiscard]] int master_fd() const { return master_.get(); }
  [[nodiscard]] const std::string& link() const { return link_; }
  /// Returns the path of the slave, for example /dev/pts/5.
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Call this when a master has opened or closed the slave. When no master has it open any more, discards
  /// the bytes that no master has read, as a serial port does: the next master must not receive a reply to
  /// the previous one. Does not discard them if the next master has opened the slave before this call.
  void take_visit();
  /// Writes the bytes for the master, without blocking. The pseudo-terminal stores a limited number of bytes
  /// that no master has read, for example about 20 KiB on Linux 6.18; further bytes are lost. Returns the
  /// number of lost bytes. Writes nothing and returns 0 if no master has the slave open, because the bytes
  /// would wait for the next master.
  std::size_t write(const std::vector<std::uint8_t>& bytes);

  /// Returns the rate set on the slave, in bits per second; nullopt if it is not a known rate.
  [[nodiscard]] std::optional<std::uint32_t> baud() const;

 private:
  [[nodiscard]] bool visited() const;

  std::string link_;
  Claim claim_;
  std::string device_;
  FileDescriptor master_;
  bool unread_ = false;  ///< bytes have been written, and `take_visit` has not discarded what is left of them
};

}  // namespace ex9000::sim
