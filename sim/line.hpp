// One line with its master's end and its modules.
#pragma once

#include <memory>
#include <vector>

#include "sim/bus.hpp"
#include "sim/faults/faults.hpp"
#include "sim/input_program.hpp"
#include "sim/master.hpp"
#include "sim/module.hpp"
#include "sim/module_spec.hpp"

namespace ex9000::sim {

/// What bytes cost on a line, and how its modules tell frames apart.
struct LineKind {
  std::uint32_t times_faster = 1;  ///< than its rates say
  TimingAt timing_at = LineTiming::at;
};

/// Two wires.
constexpr LineKind kPaced{};
/// Two wires, and modules that keep to the letter: a gap of more than T1.5 spoils a Modbus frame.
constexpr LineKind kStrictlyPaced{1, LineTiming::strictly_at};
/// A Modbus frame is over when no byte follows at once and its CRC is right, else after 2 ms of quiet.
LineTiming instantly(std::uint32_t baud);
/// Bytes cost next to nothing: one takes 0.02 us at 115200 baud and 2 us at 1200.
constexpr LineKind kInstant{4000, instantly};

/// Station 0 is the master; modules follow in the order given.
class Line {
 public:
  /// All modules have their supply off; the master is at the factory's rate.
  Line(const std::vector<ModuleSpec>& modules, LineKind kind, Master::Receive receive);

  /// The supply of all modules goes on, and the time passes that they may take until they answer.
  void come_up();

  VirtualClock& clock() { return clock_; }
  [[nodiscard]] const VirtualClock& clock() const { return clock_; }
  Bus& bus() { return bus_; }
  Master& master() { return master_; }
  [[nodiscard]] const Master& master() const { return master_; }
  [[nodiscard]] std::size_t size() const { return modules_.size(); }
  SimulatedModule& module(std::size_t index) { return *modules_[index]; }
  [[nodiscard]] const SimulatedModule& module(std::size_t index) const { return *modules_[index]; }
  /// All chance here comes of `seed`; `notice` is told what faults do. Before there are any.
  void expect_trouble(std::uint64_t seed, Faults::Notice notice);
  /// What goes wrong here; on the line from the first call on.
  Faults& faults();
  /// For those who only look: null where nobody has asked for any so far.
  [[nodiscard]] const Faults* faults_so_far() const { return faults_.get(); }
  /// From now on an input of the module at `index` moves by itself.
  void move_input(std::size_t index, const InputProgram& program);
  /// Something is under way that ends by itself within milliseconds: bytes on the wires or on their way to
  /// them, the silence behind a Modbus frame, a reply that waits for its moment, a store, a module that comes
  /// up. Not what is due later by the clock alone: a host watchdog, a scheduled fault, an input that moves.
  [[nodiscard]] bool pending() const;
  /// T3.5 on this line at the master's rate.
  [[nodiscard]] VirtualTime rtu_silence() const;
  /// After how long whatever was sent before is no part of a frame any more, even if its CRC is wrong.
  [[nodiscard]] VirtualTime rtu_separate() const;

 private:
  VirtualClock clock_;
  LineKind kind_;
  Bus bus_;
  Master master_;
  std::vector<std::unique_ptr<SimulatedModule>> modules_;
  Chance chance_{1};
  Faults::Notice notice_;
  std::unique_ptr<Faults> faults_;
  std::vector<std::unique_ptr<MovedInput>> moved_inputs_;
};

}  // namespace ex9000::sim
