// A target whose modules are on simulated lines. The lines run in virtual time.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/app/play/play_observer.hpp"
#include "sim/app/play/target.hpp"
#include "sim/app/setup/setup.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::play {

/// Initial EEPROM contents, one for each module in order; nullopt: it starts with its ModuleSpec's settings.
using Memories = std::vector<std::optional<std::vector<std::uint8_t>>>;
/// From the files in `setup`, even if another process uses them; does not change them. nullopt: no file.
Memories read_memories(const sim::Setup& setup);

/// All lines have the same virtual time. The observer may be null; else it must outlive the target.
class LineTarget : public Target {
 public:
  /// For a transcript; `start` provides its module.
  explicit LineTarget(PlayObserver* observer = nullptr) : observer_(observer) {}
  /// For a scenario. Opens no files and no ports. Throws if a fault names a module that its line lacks.
  LineTarget(const sim::Setup& setup, const Memories& memories, PlayObserver* observer = nullptr);

  [[nodiscard]] sim::VirtualTime now() { return chosen().clock().virtual_now(); }

  void start(const Model& model, const Settings* preset) override;
  void send(const Bytes& bytes) override;
  Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override { chosen().master().set_baud(rate); }
  void set_format(LineFormat format) override { chosen().master().set_format(format); }
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override;
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override { return module().outputs(); }
  Led led(Led expected) override;
  void choose_module(std::size_t position) override;
  void choose_line(const std::string& name) override;
  std::string act(const sim::Words& words) override;

 protected:
  sim::Line& chosen() { return *lines_[line_]; }
  sim::SimulatedModule& module() { return chosen().module(module_); }

 private:
  void on_module(sim::Words action);
  void run_until(sim::VirtualTime until);
  void add_line(const sim::LineSetup& setup, Memories::const_iterator memories, std::uint64_t seed);
  void turn_to(std::size_t line, std::size_t module);

  PlayObserver* observer_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<sim::Line>> lines_;
  std::vector<Bytes> heard_;  ///< for each line: received bytes that have not been returned or discarded
  std::size_t line_ = 0;
  std::size_t module_ = 0;  ///< position on the chosen line
};

}  // namespace ex9000::play
