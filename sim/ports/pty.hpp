// A pseudo-terminal with a link to it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sim/ports/claim.hpp"

namespace ex9000::sim {

/// Owns the end that the simulator has. Masters come and go at the other one; its settings stay. Raw mode.
class Pty {
 public:
  /// Makes a pseudo-terminal set to `baud` and a symbolic link to its slave at `link`. A link that a dead
  /// simulator has left is taken over. Throws std::invalid_argument, one line, where anything else is there
  /// or the path cannot be made, std::runtime_error where the system has no pseudo-terminal; then nothing is
  /// left behind.
  Pty(std::string link, std::uint32_t baud);
  /// Removes the link, if it is still this one's.
  ~Pty();
  Pty(const Pty&) = delete;
  Pty& operator=(const Pty&) = delete;

  /// The end that the simulator reads and writes; non-blocking. Reading fails while nobody has the slave
  /// open.
  [[nodiscard]] int master_fd() const { return master_; }
  [[nodiscard]] const std::string& link() const { return link_; }
  /// Of the slave, as /dev/pts/5.
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Becomes readable when somebody opens or closes the slave; then call `take_visits`.
  [[nodiscard]] int visits_fd() const { return visits_; }
  /// Where nobody had the slave open and somebody has it now, what was left unread is forgotten, as on a
  /// serial port: a reply to one master must not be the next one's first.
  void take_visits();
  /// Somebody has the slave open. What is written while nobody has would wait for the next one, so do not.
  [[nodiscard]] bool visited() const;

  /// The rate that is set on the slave now, in bits per second; nothing where it has no number.
  [[nodiscard]] std::optional<std::uint32_t> baud() const;

 private:
  void make(std::uint32_t baud);
  void close_all() const;

  std::string link_;
  Claim claim_;
  std::string device_;
  int master_ = -1;
  int visits_ = -1;
  bool deserted_ = true;  ///< nobody had the slave open when it was last looked at
};

}  // namespace ex9000::sim
