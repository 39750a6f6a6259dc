// The core in virtual time as a transcript's target.
#pragma once

#include <optional>

#include "hal/doubles/virtual_clock.hpp"
#include "sim/bus.hpp"
#include "sim/master.hpp"
#include "sim/module.hpp"
#include "tests/runner/coverage.hpp"
#include "tests/runner/target.hpp"

namespace ex9000::runner {

/// A module and a master on a virtual bus.
class CoreTarget final : public Target {
 public:
  /// What the transcripts reach is noted in `coverage`, where there is one.
  explicit CoreTarget(Coverage* coverage = nullptr) : coverage_(coverage) {}

  void start(const Model& model, const Settings* preset) override;
  void send(const Bytes& bytes) override;
  Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  Bytes listen(std::chrono::milliseconds time) override;
  void set_baud(std::uint32_t rate) override;
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override { module_->set_init(asserted); }
  void set_input(unsigned channel, bool level) override { module_->set_input(channel, level); }
  void pulse_input(unsigned channel, std::uint32_t count) override { module_->pulse_input(channel, count); }
  std::uint16_t outputs() override { return module_->outputs(); }
  step::Led::Shows led(step::Led::Shows expected) override;

  [[nodiscard]] sim::VirtualTime now() const { return clock_.virtual_now(); }

 private:
  Bytes take_heard();
  void note_coverage(const Bytes& heard);

  Coverage* coverage_;
  sim::VirtualClock clock_;
  sim::Bus bus_{clock_};
  std::optional<sim::SimulatedModule> module_;
  std::optional<sim::Master> master_;
  Bytes heard_;
  Bytes sent_;  ///< since coverage was last noted
};

}  // namespace ex9000::runner
