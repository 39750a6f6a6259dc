// A pseudo-terminal that masters open like a serial port.
#pragma once

#include <sys/types.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <cstdint>
#include <string>

#include "sim/files_and_ports/ports/port.hpp"
#include "sim/files_and_ports/ports/pty.hpp"
#include "sim/files_and_ports/ports/visits.hpp"

namespace ex9000::sim {

class PtyPort final : public Port {
 public:
  /// See Pty::Pty. Also throws std::runtime_error if the system cannot watch the pseudo-terminal.
  PtyPort(boost::asio::io_context& io, const std::string& link, std::uint32_t baud,
          const std::optional<PtyAccess>& access = std::nullopt);
  ~PtyPort() override;

  [[nodiscard]] PortSummary summary() const override;
  void start(Arrivals& arrivals) override;
  void resume() override;
  void read_waiting() override;
  std::size_t send(const std::vector<std::uint8_t>& bytes) override { return pty_.write(bytes); }
  [[nodiscard]] std::optional<std::uint32_t> baud() const override { return pty_.baud(); }

 private:
  /// Reads bytes whenever they arrive, until no master has the slave open or the port must wait for `resume`.
  void read();
  [[nodiscard]] ssize_t take();
  int watch();

  Pty pty_;
  Visits& visits_;
  int watch_;
  boost::asio::posix::stream_descriptor descriptor_;
  Arrivals* arrivals_ = nullptr;  ///< null until `start`
  bool reading_ = false;
  bool paused_ = false;
  std::array<std::uint8_t, 4096> bytes_{};  ///< a member, so that it is filled with zeros only once
};

}  // namespace ex9000::sim
