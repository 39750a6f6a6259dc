// A real serial port, such as a USB RS-485 adapter: a master on the real line reaches the simulated modules.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <optional>
#include <string>

#include "hal/serial_mode.hpp"
#include "sim/files_and_ports/ports/own_echo.hpp"
#include "sim/files_and_ports/ports/parity_marks.hpp"
#include "sim/files_and_ports/ports/port.hpp"

namespace ex9000::sim {

class SerialPort final : public Port {
 public:
  /// For exclusive use (TIOCEXCL, flock). `echo`: the adapter receives what it sends. std::runtime_error: it
  /// cannot be opened or is in use. All messages begin with `place` and `device`.
  SerialPort(boost::asio::io_context& io, const std::string& place, const std::string& device,
             hal::SerialMode mode, bool echo);

  [[nodiscard]] PortSummary summary() const override;
  /// If the port disappears, `run` of the io_context throws std::runtime_error.
  void start(Arrivals& arrivals) override;
  void resume() override;
  std::size_t send(const std::vector<std::uint8_t>& bytes) override;
  void sent() override;
  [[nodiscard]] bool is_a_line() const override { return true; }

 private:
  void read();
  void take(std::size_t size);
  void write_out();

  std::string device_;
  std::string where_;  ///< place and device, for messages
  boost::asio::posix::stream_descriptor descriptor_;
  Arrivals* arrivals_ = nullptr;  ///< null until `start`
  std::array<std::uint8_t, 4096> buffer_{};
  bool paused_ = false;
  std::vector<std::uint8_t> held_back_;
  OwnEcho::Clock::time_point began_;  ///< when the first byte in held_back_ was stored
  bool under_way_ = false;            ///< the beginning of a reply has been written, but not its end
  std::size_t dropped_ = 0;           ///< bytes that the kernel had no room for since the last `send`
  std::optional<OwnEcho> echo_;
  std::optional<ParityMarks> marks_;  ///< nullopt: the format has no parity
};

}  // namespace ex9000::sim
