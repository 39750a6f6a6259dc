#include "sim/app/play/rehearsal.hpp"

#include <stdexcept>
#include <string>

#include "sim/text/fail.hpp"

namespace ex9000::play {

namespace {

class Rehearsal {
 public:
  explicit Rehearsal(BusTarget& bus) : bus_(bus) {}

  void operator()(const step::OnModule& step) { bus_.choose_module(step.position); }
  void operator()(const step::OnLine& step) { bus_.choose_line(step.name); }
  void operator()(const step::Input& step) { bus_.require_input(step.channel); }
  void operator()(const step::Pulse& step) { bus_.require_input(step.channel); }
  void operator()(const step::FaultCommand& step) { bus_.run_fault_command(step.command); }
  template <class Other>
  void operator()(const Other& /*step*/) {}

 private:
  BusTarget& bus_;
};

}  // namespace

void rehearse(const Transcript& scenario, BusTarget& bus) {
  Rehearsal rehearsal(bus);
  for (const Step& step : scenario.steps) {
    try {
      std::visit(rehearsal, step.action);
    } catch (const std::runtime_error& error) {
      sim::fail(scenario.file + ":" + std::to_string(step.line) + ": " + step.text + ": " + error.what());
    }
  }
}

}  // namespace ex9000::play
