// A target for transcripts: a module on a line, with a rig.
#pragma once

#include <exception>

#include "sim/app/play/target.hpp"
#include "sim/utility/verify/init_mode.hpp"

namespace ex9000::utility {

class ModuleTarget final : public play::Target {
 public:
  /// `serial_number`: at the start of each transcript. `latency`: of the port; replies may come so much
  /// later.
  ModuleTarget(MasterLine& line, Rig& rig, std::uint32_t serial_number, Time latency)
      : line_(line), rig_(rig), init_mode_(line, rig), serial_number_(serial_number), latency_(latency) {}

  /// If the last transcript failed for a reason that is not the module's, throws this.
  void throw_problem() const;

  void start(const Model& model, const Settings* preset) override;
  void send(const play::Bytes& bytes) override;
  play::Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  play::Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override { set_mode({rate, mode_.format}); }
  void set_format(LineFormat format) override { set_mode({mode_.baud, format}); }
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override;
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override;
  play::Led led(play::Led expected) override;
  void end() override;

 private:
  /// Notes what `action` throws: the player reports each exception as a failure of the module.
  template <class Action>
  auto noting(Action action) {
    try {
      return action();
    } catch (...) {
      problem_ = std::current_exception();
      throw;
    }
  }
  std::string ask(const std::string& request);
  void hear_until(Time end);
  void set_mode(hal::SerialMode mode);
  void switch_inputs_off(const Model& model);

  MasterLine& line_;
  Rig& rig_;
  InitMode init_mode_;
  std::uint32_t serial_number_;
  Time latency_;
  hal::SerialMode mode_{9600, LineFormat::k8N1};
  play::Bytes heard_;
  unsigned inputs_ = 0xFFFF;  ///< bit n: input n may be on
  std::exception_ptr problem_;
};

}  // namespace ex9000::utility
