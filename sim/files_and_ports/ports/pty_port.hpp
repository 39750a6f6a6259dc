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

/// The simulator's end, in raw mode. The masters' end (the slave) keeps its settings between masters.
class PtyPort final : public Port {
 public:
  /// Makes `link` a link to the slave; replaces a link to a pseudo-terminal if no other simulator uses it.
  /// std::runtime_error: another simulator uses the path, or the system cannot create, set up or watch a
  /// pseudo-terminal. std::invalid_argument: also if the user may not use the group in `access`. After an
  /// exception, neither a new link nor a new pseudo-terminal remains.
  PtyPort(boost::asio::io_context& io, std::string link, std::uint32_t baud,
          const std::optional<PtyAccess>& access = std::nullopt);
  /// Removes the link if it still leads to this slave.
  ~PtyPort() override;

  [[nodiscard]] PortSummary summary() const override;
  void start(Arrivals& arrivals) override;
  void resume() override;
  void read_waiting() override;
  /// The pseudo-terminal stores a limited number of unread bytes, about 20 KiB on Linux 6.18; more are lost.
  /// Writes nothing while no master has the slave open: the bytes would wait for the next master.
  std::size_t send(const std::vector<std::uint8_t>& bytes) override;
  [[nodiscard]] std::optional<std::uint32_t> baud() const override;

 private:
  void visited();
  [[nodiscard]] bool is_open_at_a_master() const;
  void end_visit();
  /// Until no master has the slave open, or the port must wait for `resume`.
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
