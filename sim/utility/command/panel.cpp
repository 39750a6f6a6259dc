#include "sim/utility/command/panel.hpp"

#include <algorithm>

#include "sim/app/exports/description.hpp"
#include "sim/front_ends/panel/panel_server.hpp"
#include "sim/utility/command/scan_line.hpp"
#include "sim/utility/real_line/real_line.hpp"

namespace ex9000::utility {

namespace {

/// More often shows no more, and fills the list of frames.
constexpr std::chrono::milliseconds kBetweenLooks{100};
/// For a reply to a poll: longer would make pages wait for a module that is off.
constexpr std::chrono::milliseconds kPatienceForPolls{300};

/// Without those whose model is not known, by address.
std::vector<FoundModule> modules_to_show(Environment& environment, std::vector<FoundModule> found) {
  const auto unknown = [&](const FoundModule& module) {
    if (!module.garbled && module.identity.model != nullptr) {
      return false;
    }
    environment.error << "not shown: address " << +module.address << ": "
                      << (module.garbled ? "several modules, or noise; connect one alone"
                                         : "the model of '" + module.identity.name +
                                               "' is unknown; give it the name that its maker did")
                      << std::endl;
    return true;
  };
  found.erase(std::remove_if(found.begin(), found.end(), unknown), found.end());
  if (found.empty()) {
    throw Failed("there is no module to show");
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const FoundModule& a, const FoundModule& b) { return a.address < b.address; });
  return found;
}

}  // namespace

bool panel(Environment& environment, const sim::Words& args, const Options& options) {
  const Port port = parse_port(args[0]);
  if (port.kind == Port::Kind::ModbusTcp) {
    sim::fail("Modbus TCP shows no frames of the line; name a serial port, or tcp:HOST:PORT");
  }
  RealLine real(environment, port, options.line, std::max<Time>(kPatienceForPolls, options.timeout));
  Search search = search_of(real.line(), options);
  search.modes = {options.line};
  sim::Panel panel(
      nullptr,
      [&](std::size_t /*line*/, sim::RequestQueue::Request request) { real.ask(std::move(request)); }, 1);
  real.show_on(panel, modules_to_show(environment, print_modules(environment, real.line(), search, false)));
  sim::PanelServer server(*real.line().connection().io(), std::nullopt,
                          sim::description(sim::all_models()).dump(), panel);
  environment.output << "panel: " << server.address() << "\npress Ctrl-C to end it" << std::endl;
  server.start();
  try {
    for (;;) {
      real.look();
      real.line().connection().pause(kBetweenLooks);
    }
  } catch (const Interrupted&) {
    return true;
  }
}

}  // namespace ex9000::utility
