// A target for transcripts: an image that runs on a simulated microcontroller and its board.
#pragma once

#include <optional>

#include "sim/app/play/target.hpp"
#include "tests/mcu_model/board_bench.hpp"

namespace ex9000::registers {

class RegisterTarget final : public play::Target {
 public:
  /// `image` must be built for the model that the caller passes to `start`.
  explicit RegisterTarget(const Image& image) : bench_(image) {}

  void start(const Model& model, const Settings* preset) override;
  void send(const play::Bytes& bytes) override;
  play::Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  play::Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override { bench_.line.set_baud(rate); }
  void set_format(LineFormat format) override { bench_.line.set_format(format); }
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override { bench_.set_init(asserted); }
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override { return bench_.outputs(); }
  play::Led led(play::Led expected) override;

  BoardBench& bench() { return bench_; }

 private:
  play::Bytes take_heard();

  BoardBench bench_;
};

}  // namespace ex9000::registers
