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

/// The speed of a line and the timing of its modules.
struct LineKind {
  std::uint32_t times_faster = 1;  ///< factor for all nominal rates
  TimingAt timing_at = LineTiming::at;
  std::size_t fewest_to_share = Wires::kFewestToShare;  ///< see Wires
};

/// Bytes take as long as on a real line.
constexpr LineKind kPaced{};
/// Bytes take as long as on a real line. A gap of more than T1.5 makes a Modbus frame invalid, as Modbus over
/// Serial Line V1.02, 2.5.1.1, requires.
constexpr LineKind kStrictlyPaced{1, LineTiming::strictly_at};
/// Returns the timing of an instant line. A valid Modbus frame ends after a silence of about 6 us, and any
/// other Modbus frame ends after a silence of about 2 ms. The turn-around time of DCON is 0.
LineTiming instantly(std::uint32_t baud, LineFormat format);
/// Bytes take almost no time: each takes about 0.02 us at 115200 baud and about 2 us at 1200 baud.
constexpr LineKind kInstant{4000, instantly};

/// A line with a master and modules. Station 0 of Wires is the master. The next stations are the modules,
/// in the order in which the constructor gets them.
class Line {
 public:
  /// Creates a line with these modules. At first, the supply of the modules is off, and the master uses the
  /// factory baud rate and 8N1. `receive` is called for each byte that the master receives.
  Line(const std::vector<ModuleSpec>& modules, LineKind kind, Master::Receive receive);

  /// Switches on the supply of all modules and runs the line for 100 ms, in which the modules start up.
  void come_up();

  VirtualClock& clock() { return clock_; }
  [[nodiscard]] const VirtualClock& clock() const { return clock_; }
  Wires& wires() { return wires_; }
  Master& master() { return master_; }
  [[nodiscard]] const Master& master() const { return master_; }
  [[nodiscard]] const FrameSpacing& spacing() const { return spacing_; }
  /// Returns the queue for the requests of the Modbus TCP gateway and of the panel. The first call attaches
  /// the queue to the wires.
  RequestQueue& requests();
  [[nodiscard]] std::size_t size() const { return modules_.size(); }
  SimulatedModule& module(std::size_t index) { return *modules_[index]; }
  [[nodiscard]] const SimulatedModule& module(std::size_t index) const { return *modules_[index]; }
  /// Sets the seed of all random faults and of bouncing contacts; `notice` gets the messages about faults.
  /// Call this before `faults` and `move_input`.
  void configure_faults(std::uint64_t seed, Faults::Notice notice);
  /// Returns the faults of this line. The first call attaches them to the wires.
  Faults& faults();
  /// Returns the faults of this line without attaching them; null if `faults` has not been called yet.
  [[nodiscard]] const Faults* faults_so_far() const { return faults_.get(); }
  /// Starts `program`, which changes the level of an input of the module at `index`.
  void move_input(std::size_t index, const InputProgram& program);
  /// Returns whether something is in progress that ends by itself, usually within milliseconds: a byte on the
  /// wires, an enabled driver, bytes that a station still has to send, the silence after a Modbus frame, the
  /// turn-around time after a DCON frame, a request that a module processes, a delayed reply, a store, the
  /// start of a module, or a change of the active faults. Events that depend only on the clock do not count,
  /// for example a host watchdog, a scheduled fault or an input program. Requests that wait in `requests` do
  /// not count either.
  [[nodiscard]] bool unsettled() const;
  /// Returns whether the line is unsettled, or a request in `requests` waits or is in progress.
  [[nodiscard]] bool pending() const;
  /// Returns the longest response delay of the modules (extensions.md, register 0x0252).
  [[nodiscard]] VirtualTime longest_response_delay() const;
  /// Returns the silence that modules of this line require between Modbus frames, counted from the end of the
  /// first stop bit of the last byte. Except on an instant line, this is the rest of the stop bits and T3.5,
  /// at the baud rate and format of the master.
  [[nodiscard]] VirtualTime rtu_silence() const;
  /// Returns the silence after which earlier bytes cannot belong to the next frame, even if the CRC of these
  /// bytes is wrong. It is counted like `rtu_silence`.
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
