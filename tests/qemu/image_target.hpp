// A transcript target: the firmware image on the emulated board.
#pragma once

#include <chrono>
#include <map>

#include "sim/app/play/target.hpp"
#include "tests/qemu/timed_module.hpp"

namespace ex9000::rig {

/// One object can play several transcripts, one after another. Each model has its own emulator. Time is
/// emulated. alarm_clock.hpp describes how the host can affect the result.
class ImageTarget final : public play::Target {
 public:
  void start(const Model& model, const Settings* preset) override;
  void send(const play::Bytes& bytes) override;
  play::Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  play::Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override { mode_.baud = rate; }
  void set_format(LineFormat format) override { mode_.format = format; }
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override;
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override;
  play::Led led(play::Led expected) override;
  void end() override { module_->verify_led(); }

  /// Returns the emulated time since `start`.
  [[nodiscard]] std::chrono::nanoseconds now() const { return module_->now(); }

 private:
  /// Runs the module until its image has had time to process the sent bytes. Returns the module.
  TimedModule& settled();
  void hear();

  std::map<const Model*, TimedModule> modules_;
  TimedModule* module_ = nullptr;
  hal::SerialMode mode_{9600};
  std::chrono::nanoseconds settled_{0};  ///< the time until which `settled` runs the module
  play::Bytes heard_;
};

}  // namespace ex9000::rig
