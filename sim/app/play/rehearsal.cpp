#include "sim/app/play/rehearsal.hpp"

#include <exception>
#include <string>

#include "sim/app/play/playing.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::play {

void rehearse(const Transcript& scenario, LineTarget& bus) {
  Playing rehearsal(bus, false, true);
  for (const Step& step : scenario.steps) {
    try {
      if (step.acts) {
        step.run(rehearsal);
      }
    } catch (const sim::NotNow& /*error*/) {  // NOLINT(bugprone-empty-catch)
      // When the scenario is played, time has passed, and the step may be right.
    } catch (const std::exception& error) {
      sim::fail(scenario.file + ":" + std::to_string(step.line) + ": " + step.text + ": " + error.what());
    }
  }
}

}  // namespace ex9000::play
