// A pseudo-terminal with a link to it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/ports/claim.hpp"
#include "sim/files_and_ports/ports/pty_access.hpp"
#include "sim/files_and_ports/ports/terminal_rate.hpp"

namespace ex9000::sim {

/// Owns the simulator's end. Masters open and close the other end (the slave), which keeps its settings while
/// no master has it open. The constructor sets the terminal to raw mode.
class Pty {
 public:
  /// Creates a pseudo-terminal, sets its rate to `baud`, and creates a symbolic link to the slave at the path
  /// `link`. If no other simulator uses this path, replaces an existing link to a pseudo-terminal. Throws
  /// std::invalid_argument with a one-line message if anything else exists at the path, or if the link cannot
  /// be created. Throws std::runtime_error if another simulator uses the path, or if the system cannot create
  /// or set up a pseudo-terminal. If `access` has a value, sets the mode and the group of the slave; throws
  /// std::invalid_argument if the user may not use that group. After an exception, neither a new link nor a
  /// new pseudo-terminal remains.
  Pty(std::string link, std::uint32_t baud, const std::optional<PtyAccess>& access = std::nullopt);
  /// Removes the link if it still leads to this object's slave.
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  /// Returns the file descriptor of the simulator's end. Reading does not block. If all bytes have been read,
  /// reading fails: with EAGAIN if a master has the slave open, otherwise with another error.
  [[nodiscard]] int master_fd() const { return master_.get(); }
  [[nodiscard]] const std::string& link() const { return link_; }
  /// Returns the path of the slave, for example /dev/pts/5.
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Call this when a master has opened or closed the slave. Returns whether a master has it open. If no
  /// master has the slave open any more, clears CLOCAL, so that the next master can set it, and discards the
  /// bytes that no master has read, like a serial port: the next master must not receive a reply to the
  /// previous master. Does not discard them if the next master has opened the slave before this call.
  bool take_visit();
  /// Writes the bytes for the master, without blocking. The pseudo-terminal stores a limited number of bytes
  /// that no master has read, for example about 20 KiB on Linux 6.18; further bytes are lost. Returns the
  /// number of lost bytes. Writes nothing and returns 0 if no master has the slave open, because the bytes
  /// would wait for the next master.
  std::size_t write(const std::vector<std::uint8_t>& bytes);

  /// Returns the rate set on the slave, see `terminal_rate`.
  [[nodiscard]] std::optional<std::uint32_t> baud() const { return terminal_rate(master_fd()); }

 private:
  [[nodiscard]] bool visited() const;

  std::string link_;
  Claim claim_;
  std::string device_;
  FileDescriptor master_;
  bool unread_ = false;  ///< true from a write until `take_visit` discards the unread bytes
};

}  // namespace ex9000::sim
