// The firmware image on the emulated board as a transcript's target, in real time.
#pragma once

#include <chrono>
#include <optional>

#include "tests/rig/emulated_module.hpp"
#include "tests/runner/target.hpp"

namespace ex9000::rig {

/// May play one transcript after the other; those of one model in a row are played on one emulator.
///
/// Bytes take no time on the emulated UART. What is sent at a rate that is not the image's is put on its line
/// as the image would sample it, and the other way round.
class ImageTarget final : public runner::Target {
 public:
  void start(const Model& model, const Settings* preset) override;
  void send(const runner::Bytes& bytes) override;
  runner::Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  runner::Bytes listen(std::chrono::milliseconds time) override;
  void set_baud(std::uint32_t rate) override { baud_ = rate; }
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override;
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override;
  runner::step::Led::Shows led(runner::step::Led::Shows expected) override;

 private:
  using Clock = std::chrono::steady_clock;

  /// The module, once it has done what was sent to it.
  EmulatedModule& settled();
  void hear(std::chrono::nanoseconds patience);
  void hear_until(Clock::time_point when);
  /// While so much time passes on the image's clock, where it has one.
  void hear_for(std::chrono::milliseconds time);
  /// The image has had the time to come up.
  void come_up();

  std::optional<EmulatedModule> module_;
  std::uint32_t baud_ = 0;
  Clock::time_point settled_;  ///< when the image has had the time for what was sent
  runner::Bytes heard_;
};

}  // namespace ex9000::rig
