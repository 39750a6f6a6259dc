// A real serial port, such as a USB RS-485 adapter: the modules hang on the line behind it.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <optional>
#include <string>

#include "sim/ports/own_echo.hpp"
#include "sim/ports/port.hpp"

namespace ex9000::sim {

class SerialPort final : public Port {
 public:
  /// Opens `device`, 8N1 at `baud`, and keeps others from opening it. `echo`: the adapter hears what it
  /// sends. Throws std::invalid_argument, one line, where that cannot be had.
  SerialPort(boost::asio::io_context& io, std::string device, std::uint32_t baud, bool echo);

  /// Ends the io_context's run with a std::runtime_error when the port goes away.
  void start(Received received) override;
  void resume() override;
  std::size_t send(const std::vector<std::uint8_t>& bytes) override;
  void sent() override;
  [[nodiscard]] bool is_a_line() const override { return true; }

 private:
  void read();
  void take(std::size_t size);
  void write_out();

  std::string device_;
  boost::asio::posix::stream_descriptor descriptor_;
  Received received_;
  std::array<std::uint8_t, 4096> buffer_{};
  bool paused_ = false;
  std::vector<std::uint8_t> held_back_;
  OwnEcho::Clock::time_point began_;  ///< when the first of them came
  bool under_way_ = false;            ///< the beginning of a reply has been written
  std::optional<OwnEcho> echo_;
};

}  // namespace ex9000::sim
