#include "sim/virtual_line/line/line.hpp"

#include <algorithm>
#include <utility>

namespace ex9000::sim {

/// A correct CRC proves a frame complete, so a very short silence ends it. Any other frame may be arriving in
/// pieces, so only a longer silence ends it.
LineTiming instantly(std::uint32_t /*baud*/, LineFormat /*format*/) {
  constexpr Duration kSilence(6);
  constexpr Duration kQuiet = milliseconds(2);
  LineTiming timing;
  timing.dcon_turn_around = Duration();
  timing.rtu_silence = kSilence;
  timing.rtu_grace = kQuiet;
  timing.rtu_slack = LineTiming::kAnyGap;
  timing.arbitration = kSilence;
  timing.window_64ths = 64 * 10;  // at 1200 baud, a byte and the driver take 6 us
  return timing;
}

/// Interrupts of different modules differ by a few microseconds.
VirtualTime usual_skew(std::size_t module) {
  constexpr std::size_t kDifferent = 5;
  return std::chrono::microseconds(module % kDifferent);
}

Line::Line(const std::vector<ModuleSpec>& modules, LineKind kind, Master::Receive receive)
    : kind_(kind),
      wires_(clock_, kind.times_faster, kind.fewest_to_share),
      master_(wires_, SerialMode{baud_rate(kFactoryBaudCode)}, std::move(receive)),
      spacing_(*this) {
  for (const ModuleSpec& spec : modules) {
    modules_.push_back(std::make_unique<SimulatedModule>(wires_, *spec.model, kind.timing_at));
    SimulatedModule& module = *modules_.back();
    module.store(spec.settings);
    module.set_init(spec.init_asserted);
    module.set_serial_number(spec.serial_number);
    module.set_skew(
        spec.skew.value_or(kind.times_faster == 1 ? usual_skew(modules_.size()) : VirtualTime(0)));
  }
}

void Line::come_up() {
  constexpr std::chrono::milliseconds kComingUp{100};
  for (const auto& module : modules_) {
    module->power(true);
  }
  wires_.run_for(kComingUp);
}

void Line::configure_faults(std::uint64_t seed, Faults::Notice notice) {
  chance_ = Chance(seed);
  notice_ = std::move(notice);
}

Faults& Line::faults() {
  if (!faults_) {
    faults_ = std::make_unique<Faults>(wires_, master_, modules_, chance_.number(), notice_);
  }
  return *faults_;
}

RequestQueue& Line::requests() {
  if (!requests_) {
    requests_ = std::make_unique<RequestQueue>(*this);
  }
  return *requests_;
}

void Line::move_input(std::size_t index, const InputProgram& program) {
  moved_inputs_.push_back(std::make_unique<MovedInput>(wires_, *modules_[index], program, chance_.number()));
}

bool Line::unsettled() const {
  return wires_.busy() || wires_.waits_for_silence() || master_.sending() ||
         (faults_ && faults_->pending()) ||
         std::any_of(modules_.begin(), modules_.end(), [](const auto& module) { return module->pending(); });
}

bool Line::pending() const { return unsettled() || (requests_ && requests_->busy()); }

VirtualTime Line::longest_response_delay() const {
  std::chrono::milliseconds longest{0};
  for (const auto& module : modules_) {
    if (module->powered()) {
      const std::chrono::milliseconds delay{module->module().state().settings.response_delay};
      longest = std::max(longest, delay);
    }
  }
  return longest;
}

LineTiming Line::timing() const { return kind_.timing_at(master_.mode().baud, master_.mode().format); }

VirtualTime Line::rtu_silence() const {
  return std::chrono::microseconds(timing().rtu_silence.microseconds());
}

VirtualTime Line::rtu_separate() const {
  const LineTiming times = timing();
  return std::chrono::microseconds((times.rtu_silence + times.rtu_grace).microseconds());
}

}  // namespace ex9000::sim
