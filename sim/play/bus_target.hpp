// Lines in virtual time as what is played against.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/line.hpp"
#include "sim/play/onlooker.hpp"
#include "sim/play/target.hpp"
#include "sim/setup.hpp"

namespace ex9000::play {

/// What modules find in their EEPROMs, in the order of lines and modules; nothing: what their settings say.
using Memories = std::vector<std::optional<std::vector<std::uint8_t>>>;
/// Of the files that `setup` names, which are left as they are, whoever else has them. Throws
/// std::invalid_argument, one line.
Memories read_memories(const sim::Setup& setup);

/// All its lines have the same time.
class BusTarget : public Target {
 public:
  /// For a transcript, which says what module there is.
  /// `onlooker` may be null, and lives as long as this.
  explicit BusTarget(Onlooker* onlooker = nullptr) : onlooker_(onlooker) {}
  /// For a scenario: the modules of `setup` have come up, with `memories`. Neither files nor ports are
  /// opened. Throws std::invalid_argument, one line.
  BusTarget(const sim::Setup& setup, const Memories& memories, Onlooker* onlooker = nullptr);

  /// Throws std::runtime_error, as Target does, where the module lacks it.
  void want_input(unsigned channel);

  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  sim::Line& line(std::size_t index) { return *lines_[index]; }
  [[nodiscard]] sim::VirtualTime now() { return chosen().clock().virtual_now(); }
  /// All that happens until then.
  void run_until(sim::VirtualTime until);

  // --- Target ---
  void start(const Model& model, const Settings* preset) override;
  void send(const Bytes& bytes) override;
  Bytes receive(std::size_t count, std::chrono::milliseconds patience) override;
  Bytes listen(std::chrono::nanoseconds time) override;
  void set_baud(std::uint32_t rate) override { chosen().master().set_baud(rate); }
  void power(bool on) override;
  void reset() override;
  void set_init(bool asserted) override { module().set_init(asserted); }
  void set_input(unsigned channel, bool level) override;
  void pulse_input(unsigned channel, std::uint32_t count) override;
  std::uint16_t outputs() override { return module().outputs(); }
  step::Led::Shows led(step::Led::Shows expected) override;
  void choose_module(std::size_t position) override;
  void choose_line(const std::string& name) override;
  void trouble(const std::string& command) override;

 protected:
  sim::Line& chosen() { return *lines_[line_]; }
  sim::SimulatedModule& module() { return chosen().module(module_); }

 private:
  void add_line(const sim::LineSetup& setup, Memories::const_iterator memories, std::uint64_t seed);
  void turn_to(std::size_t line, std::size_t module);

  Onlooker* onlooker_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<sim::Line>> lines_;
  std::vector<Bytes> heard_;  ///< by the master of each line, since the steps were last about another
  std::size_t line_ = 0;
  std::size_t module_ = 0;  ///< on that line
};

}  // namespace ex9000::play
