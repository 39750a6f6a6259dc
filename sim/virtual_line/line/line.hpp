// One line with its master station and its modules.
#pragma once

#include <memory>
#include <vector>

#include "sim/virtual_line/bus/bus.hpp"
#include "sim/virtual_line/bus/master.hpp"
#include "sim/virtual_line/bus/module.hpp"
#include "sim/virtual_line/faults/faults.hpp"
#include "sim/virtual_line/line/frame_spacing.hpp"
#include "sim/virtual_line/line/input_program.hpp"
#include "sim/virtual_line/line/module_spec.hpp"
#include "sim/virtual_line/line/request_queue.hpp"

namespace ex9000::sim {

/// The speed of a line, and the rules by which its modules detect the end of frames.
struct LineKind {
  std::uint32_t times_faster = 1;  ///< compared to the nominal rates
  TimingAt timing_at = LineTiming::at;
};

/// Bytes take their real time.
constexpr LineKind kPaced{};
/// Bytes take their real time, and modules follow the standard strictly: a gap of more than T1.5 makes a
/// Modbus frame invalid.
constexpr LineKind kStrictlyPaced{1, LineTiming::strictly_at};
/// Returns the timing of an instant line: a Modbus frame with a correct CRC ends when no byte follows
/// immediately; any other Modbus frame ends after a silence of 2 ms.
LineTiming instantly(std::uint32_t baud, LineFormat format);
/// Bytes take almost no time: each takes 0.02 us at 115200 baud and 2 us at 1200 baud.
constexpr LineKind kInstant{4000, instantly};

/// Station 0 of the bus is the master; the modules follow in the given order.
class Line {
 public:
  /// Creates a line with these modules. Their supply is off at first. The master uses the factory baud rate.
  /// `receive` gets each byte that the master receives.
  Line(const std::vector<ModuleSpec>& modules, LineKind kind, Master::Receive receive);

  /// Switches on the supply of all modules and runs the line for 100 ms, in which the modules start up.
  void come_up();

  VirtualClock& clock() { return clock_; }
  [[nodiscard]] const VirtualClock& clock() const { return clock_; }
  Bus& bus() { return bus_; }
  Master& master() { return master_; }
  [[nodiscard]] const Master& master() const { return master_; }
  [[nodiscard]] const FrameSpacing& spacing() const { return spacing_; }
  /// Returns the queue for the requests of the Modbus TCP gateway and of the panel. The first call attaches
  /// the queue to the bus.
  RequestQueue& requests();
  [[nodiscard]] std::size_t size() const { return modules_.size(); }
  SimulatedModule& module(std::size_t index) { return *modules_[index]; }
  [[nodiscard]] const SimulatedModule& module(std::size_t index) const { return *modules_[index]; }
  /// Sets the seed of all random faults and of bouncing contacts; `notice` gets the messages about faults.
  /// Call this before `faults` and `move_input`.
  void configure_faults(std::uint64_t seed, Faults::Notice notice);
  /// Returns the faults of this line. The first call attaches them to the bus.
  Faults& faults();
  /// Returns the faults of this line without attaching them; null if `faults` has not been called yet.
  [[nodiscard]] const Faults* faults_so_far() const { return faults_.get(); }
  /// Starts `program`, which changes the level of an input of the module at `index`.
  void move_input(std::size_t index, const InputProgram& program);
  /// Returns whether something is in progress that ends by itself, usually within milliseconds: bytes on the
  /// wires or in a queue, the silence after a Modbus frame, a delayed reply, a store, a module that starts
  /// up. Events that depend only on the clock do not count: a host watchdog, a scheduled fault, an input
  /// program.
  [[nodiscard]] bool unsettled() const;
  /// Returns whether the line is unsettled, or a request of the queue waits or is in progress.
  [[nodiscard]] bool pending() const;
  /// Returns the silence that modules of this line require after the first stop bit of the last byte. On a
  /// paced line, this is the rest of the stop bits and T3.5, in the master's mode.
  [[nodiscard]] VirtualTime rtu_silence() const;
  /// Returns the silence after which earlier bytes cannot belong to the next frame, even if the CRC of these
  /// bytes is wrong.
  [[nodiscard]] VirtualTime rtu_separate() const;

 private:
  [[nodiscard]] LineTiming timing() const;

  VirtualClock clock_;
  LineKind kind_;
  Bus bus_;
  Master master_;
  FrameSpacing spacing_;
  std::vector<std::unique_ptr<SimulatedModule>> modules_;
  Chance chance_{1};
  Faults::Notice notice_;
  std::unique_ptr<Faults> faults_;
  std::vector<std::unique_ptr<MovedInput>> moved_inputs_;
  std::unique_ptr<RequestQueue> requests_;
};

}  // namespace ex9000::sim
