#include "sim/app/play/rehearsal.hpp"

#include <stdexcept>
#include <string>

#include "sim/text/fail.hpp"

namespace ex9000::play {

namespace {

struct Rehearsal {
  BusTarget& bus;

  void operator()(const step::OnModule& step) { bus.choose_module(step.position); }
  void operator()(const step::OnLine& step) { bus.choose_line(step.name); }
  void operator()(const step::Input& step) { bus.require_input(step.channel); }
  void operator()(const step::Pulse& step) { bus.require_input(step.channel); }
  void operator()(const step::FaultCommand& step) { bus.run_fault_command(step.command); }
  template <class Other>
  void operator()(const Other& /*step*/) {}
};

}  // namespace

void rehearse(const Transcript& scenario, BusTarget& bus) {
  for (const Step& step : scenario.steps) {
    try {
      std::visit(Rehearsal{bus}, step.action);
    } catch (const std::runtime_error& error) {
      sim::fail(scenario.file + ":" + std::to_string(step.line) + ": " + step.text + ": " + error.what());
    }
  }
}

}  // namespace ex9000::play
