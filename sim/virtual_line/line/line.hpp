// One line with its master station and its modules.
#pragma once

#include <memory>
#include <vector>

#include "sim/virtual_line/faults/faults.hpp"
#include "sim/virtual_line/line/frame_spacing.hpp"
#include "sim/virtual_line/line/input_program.hpp"
#include "sim/virtual_line/line/module_spec.hpp"
#include "sim/virtual_line/line/request_queue.hpp"
#include "sim/virtual_line/wires/master.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

struct LineKind {
  std::uint32_t times_faster = 1;  ///< factor for all nominal rates
  TimingAt timing_at = LineTiming::at;
  std::size_t fewest_to_share = Wires::kFewestToShare;  ///< see Wires
};

/// Bytes take as long as on a real line.
constexpr LineKind kPaced{};
/// As `kPaced`, but a gap of more than T1.5 spoils a Modbus frame (Modbus over Serial Line V1.02, 2.5.1.1).
constexpr LineKind kStrictlyPaced{1, LineTiming::strictly_at};
/// About 6 us of silence end a valid Modbus frame, about 2 ms any other; DCON has no turn-around time.
LineTiming instantly(std::uint32_t baud, LineFormat format);
/// A byte takes almost no time: about 0.02 us at 115200 baud, 2 us at 1200 baud.
constexpr LineKind kInstant{4000, instantly};

/// Station 0 of the wires is the master; the modules follow in the constructor's order.
class Line {
 public:
  /// Supplies are off; the master has the factory rate and 8N1. `receive` gets each byte the master hears.
  Line(const std::vector<ModuleSpec>& modules, LineKind kind, Master::Receive receive);

  /// Switches all supplies on and runs for 100 ms, in which the modules start.
  void come_up();

  VirtualClock& clock() { return clock_; }
  [[nodiscard]] const VirtualClock& clock() const { return clock_; }
  Wires& wires() { return wires_; }
  Master& master() { return master_; }
  [[nodiscard]] const Master& master() const { return master_; }
  [[nodiscard]] const FrameSpacing& spacing() const { return spacing_; }
  /// For the Modbus TCP gateway and the panel. The first call attaches the queue to the wires.
  RequestQueue& requests();
  [[nodiscard]] std::size_t size() const { return modules_.size(); }
  SimulatedModule& module(std::size_t index) { return *modules_[index]; }
  [[nodiscard]] const SimulatedModule& module(std::size_t index) const { return *modules_[index]; }
  /// Before `faults` and `move_input`. `seed`: for random faults and bouncing; `notice` hears of faults.
  void configure_faults(std::uint64_t seed, Faults::Notice notice);
  /// The first call attaches them to the wires.
  Faults& faults();
  /// Null before the first `faults()`.
  [[nodiscard]] const Faults* faults_so_far() const { return faults_.get(); }
  void move_input(std::size_t index, const InputProgram& program);
  /// Something is in progress that ends by itself, usually within milliseconds: a byte on the wires, an
  /// enabled driver, bytes to send, the silence after a Modbus frame or the turn-around after a DCON frame, a
  /// request, a late reply, a store, a module's start, a change of the active faults. What only waits for the
  /// clock does not count (host watchdog, scheduled fault, input program), nor what waits in `requests`.
  [[nodiscard]] bool unsettled() const;
  [[nodiscard]] bool pending() const;
  /// Of all modules (extensions.md, register 0x0252).
  [[nodiscard]] VirtualTime longest_response_delay() const;
  /// The silence that modules need between Modbus frames, from the end of the last byte's first stop bit: the
  /// rest of the stop bits and T3.5 in the master's mode, except on an instant line.
  [[nodiscard]] VirtualTime rtu_silence() const;
  /// After this silence (counted likewise), even bytes with a wrong CRC cannot belong to the next frame.
  [[nodiscard]] VirtualTime rtu_separate() const;

 private:
  [[nodiscard]] LineTiming timing() const;

  VirtualClock clock_;
  LineKind kind_;
  Wires wires_;
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
