// A real serial port, such as a USB RS-485 adapter: the modules hang on the line behind it.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <string>

#include "sim/ports/own_echo.hpp"
#include "sim/ports/port.hpp"

namespace ex9000::sim {

class SerialPort final : public Port {
 public:
  /// Opens `device` for this process alone, 8N1 at `baud`. Throws std::invalid_argument, one line, where that
  /// cannot be had.
  SerialPort(boost::asio::io_context& io, std::string device, std::uint32_t baud);
  ~SerialPort() override;

  /// Ends the io_context's run with a std::runtime_error when the port goes away.
  void start(Received received) override;
  void resume() override;
  void send(const std::vector<std::uint8_t>& bytes) override;
  void sent() override;
  [[nodiscard]] bool is_a_line() const override { return true; }

 private:
  void open_device();
  void read();
  void write_out();

  std::string device_;
  std::uint32_t baud_;
  int fd_ = -1;
  boost::asio::posix::stream_descriptor descriptor_;
  Received received_;
  std::array<std::uint8_t, 4096> buffer_{};
  bool paused_ = false;
  std::vector<std::uint8_t> held_back_;
  OwnEcho::Clock::time_point began_;  ///< when the first of them came
  bool under_way_ = false;            ///< the beginning of a reply has been written
  bool has_wires_ = false;            ///< what is sent takes its time; a pseudo-terminal has none
  OwnEcho echo_;
};

}  // namespace ex9000::sim
