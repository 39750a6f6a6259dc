#include "sim/line.hpp"

#include <utility>

namespace ex9000::sim {

Line::Line(const std::vector<ModuleSpec>& modules, std::uint32_t baud, InterCharacterGap gap,
           Master::Receive receive)
    : master_(bus_, baud, std::move(receive)) {
  for (const ModuleSpec& spec : modules) {
    modules_.push_back(std::make_unique<SimulatedModule>(bus_, *spec.model, gap));
    SimulatedModule& module = *modules_.back();
    if (spec.settings != Settings::factory(*spec.model)) {
      module.store(spec.settings);
    }
    module.set_init(spec.init_asserted);
    module.power(true);
  }
}

}  // namespace ex9000::sim
