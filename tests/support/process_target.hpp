// A module of a running ex9000-sim as a transcript's target: its pseudo-terminal and its control socket, in
// real time.
#pragma once

#include <chrono>
#include <string>

#include "sim/play/target.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {

class ProcessTarget final : public play::Target {
 public:
  /// The module with `number` on the control socket, alone on the line whose pseudo-terminal `tty` is. It is
  /// as `start` wants it.
  ProcessTarget(const std::string& tty, const std::string& control, std::size_t number);

  void start(const Model& model, const Settings* preset) override;
  void send(const play::Bytes& bytes) override;
  play::Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  play::Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override;
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override;
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override;
  play::step::Led::Shows led(play::step::Led::Shows expected) override;

 private:
  using Clock = std::chrono::steady_clock;

  /// A command for the module, once the line has carried what was sent before.
  std::string control(const std::string& command);
  void hear_until(Clock::time_point when);
  play::Bytes take_heard();

  std::string number_;
  Terminal terminal_;
  ControlClient control_;
  std::uint32_t baud_ = 0;
  Clock::time_point line_free_;  ///< when all that was sent has been on the line
  play::Bytes heard_;
};

}  // namespace ex9000::system
