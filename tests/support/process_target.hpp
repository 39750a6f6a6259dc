// A transcript target: a module of a running ex9000-sim in stepped time. The target uses a port of the
// module's line and the control socket.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "sim/app/play/target.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/master_port.hpp"

namespace ex9000::system {

/// The results do not depend on real time: the simulator's time passes only during calls.
class ProcessTarget final : public play::Target {
 public:
  /// `number` identifies the module on the control socket. The module must be the only one on the line
  /// `line`, and `port` must be connected to that line. The model, the stored settings, INIT* and the inputs
  /// of the module must be as Target::start describes. The supply of the module must be off, because `start`
  /// only switches the supply on. `control` must live at least as long as this object. The simulator must run
  /// with --speed step.
  ProcessTarget(std::unique_ptr<MasterPort> port, ControlClient& control, std::string line,
                std::size_t number);

  void start(const Model& model, const Settings* preset) override;
  void send(const play::Bytes& bytes) override;
  play::Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  play::Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override;
  void set_format(LineFormat format) override;
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override;
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override;
  play::Led led(play::Led expected) override;
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
  LineFormat format_ = LineFormat::k8N1;
  std::size_t read_ = 0;  ///< number of bytes read from the port so far
  play::Bytes heard_;
};

}  // namespace ex9000::system
