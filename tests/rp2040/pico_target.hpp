// A transcript target: an image on an emulated Pico.
#pragma once

#include "sim/app/play/target.hpp"
#include "tests/rp2040/pico_bench.hpp"

namespace ex9000::pico {

/// One object can play several transcripts, one after another. Time is virtual, so the load of the host does
/// not affect the result.
class PicoTarget final : public play::Target {
 public:
  explicit PicoTarget(Memory memory = Memory::Flash) : bench_(memory) {}

  void start(const Model& model, const Settings* preset) override;
  void send(const play::Bytes& bytes) override;
  play::Bytes receive(std::size_t count, std::chrono::milliseconds patience) override {
    return bench_.receive(count, patience);
  }
  play::Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override;
  void set_format(LineFormat format) override;
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override { bench_.set_init(asserted); }
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override;
  play::Led led(play::Led expected) override;
  /// Throws std::runtime_error if a character began while the driver was off, if the driver was switched off
  /// too early or too late, if the chip and another part drove a pin to different levels, or if the watchdog
  /// has reset the chip. Ignores different levels on the pins of I2C.
  void end() override;

  /// Returns the virtual time since `start`.
  std::chrono::nanoseconds now() { return bench_.now(); }
  /// Returns the total virtual time of the transcripts for which `end` has been called.
  [[nodiscard]] std::chrono::nanoseconds played() const { return played_; }

 private:
  PicoBench bench_;
  const Model* model_ = nullptr;
  std::uint32_t baud_ = 9600;
  LineFormat format_ = LineFormat::k8N1;
  std::chrono::nanoseconds played_{0};
};

}  // namespace ex9000::pico
