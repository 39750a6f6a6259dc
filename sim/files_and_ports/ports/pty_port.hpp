// A pseudo-terminal that masters open like a serial port.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/ports/claim.hpp"
#include "sim/files_and_ports/ports/port.hpp"
#include "sim/files_and_ports/ports/pty_access.hpp"
#include "sim/files_and_ports/ports/visits.hpp"

namespace ex9000::sim {

/// Owns the simulator's end. Masters open and close the other end (the slave), which keeps its settings while
/// no master has it open. The constructor sets the terminal to raw mode.
class PtyPort final : public Port {
 public:
  /// Creates a pseudo-terminal, sets its rate to `baud`, and creates a symbolic link to the slave at the path
  /// `link`. If no other simulator uses this path, replaces an existing link to a pseudo-terminal. Throws
  /// std::invalid_argument with a one-line message if anything else exists at the path, or if the link cannot
  /// be created. Throws std::runtime_error if another simulator uses the path, or if the system cannot
  /// create, set up or watch a pseudo-terminal. If `access` has a value, sets the mode and the group of the
  /// slave; throws std::invalid_argument if the user may not use that group. After an exception, neither a
  /// new link nor a new pseudo-terminal remains.
  PtyPort(boost::asio::io_context& io, std::string link, std::uint32_t baud,
          const std::optional<PtyAccess>& access = std::nullopt);
  /// Removes the link if it still leads to this object's slave.
  ~PtyPort() override;

  [[nodiscard]] PortSummary summary() const override;
  void start(Arrivals& arrivals) override;
  void resume() override;
  void read_waiting() override;
  /// The pseudo-terminal stores a limited number of bytes that no master has read, for example about 20 KiB
  /// on Linux 6.18; further bytes are lost. Writes nothing if no master has the slave open, because the bytes
  /// would wait for the next master.
  std::size_t send(const std::vector<std::uint8_t>& bytes) override;
  [[nodiscard]] std::optional<std::uint32_t> baud() const override;

 private:
  void visited();
  [[nodiscard]] bool is_open_at_a_master() const;
  void end_visit();
  /// Reads bytes whenever they arrive, until no master has the slave open or the port must wait for `resume`.
  void read();
  [[nodiscard]] ssize_t take();

  std::string link_;
  Claim claim_;
  std::string device_;  ///< the path of the slave, for example /dev/pts/5
  Visits& visits_;
  int watch_ = -1;
  FileDescriptor master_;                             ///< the simulator's end
  boost::asio::posix::stream_descriptor descriptor_;  ///< of `master_`, from `start`
  Arrivals* arrivals_ = nullptr;                      ///< null until `start`
  bool unread_ = false;  ///< true from a write until `end_visit` discards the unread bytes
  bool reading_ = false;
  bool paused_ = false;
  std::array<std::uint8_t, 4096> bytes_{};  ///< a member, so that it is filled with zeros only once
};

}  // namespace ex9000::sim
