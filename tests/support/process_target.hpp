// A module of a running ex9000-sim as a transcript's target: one of its line's ports and its control socket,
// in stepped time.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "sim/play/target.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/master_port.hpp"

namespace ex9000::system {

/// Nothing here depends on the wall clock: the simulator's time moves only while a call lasts.
class ProcessTarget final : public play::Target {
 public:
  /// The module with `number` on the control socket, alone on the line called `line`, which `port` is
  /// connected to. It is as `start` requires, but for its supply, which is off. `control` lives as long as
  /// this object; the simulator runs with --speed step.
  ProcessTarget(std::unique_ptr<MasterPort> port, ControlClient& control, std::string line,
                std::size_t number);

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
  void end() override;

 private:
  std::string control(const std::string& command);
  void advance(std::chrono::nanoseconds time, const std::string& how = "");
  play::Bytes take_heard();

  std::unique_ptr<MasterPort> port_;
  ControlClient& control_;
  std::string line_;
  std::string number_;
  std::uint32_t baud_ = 0;
  std::size_t read_ = 0;  ///< bytes from the port so far
  play::Bytes heard_;
};

}  // namespace ex9000::system
