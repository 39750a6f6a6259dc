#include "tests/oracles/reference/generator.hpp"

#include <optional>
#include <string>
#include <utility>

#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::reference {

namespace {

Step wait(const Module& module, Random& random) {
  // Some waits are longer than the host watchdog's timeout. If a step is too close to the expiry, the session
  // waits until the expiry is over.
  if (module.expiry() && random.once_in(2)) {
    return WaitForExpiry{std::chrono::milliseconds(random.between(5, 120))};
  }
  if (module.stored().enabled && random.once_in(3)) {
    return Wait{std::chrono::milliseconds(100 * module.stored().timeout + 500)};
  }
  return Wait{std::chrono::milliseconds(random.between(1, 300))};
}

/// Returns a number of pulses: usually a few, sometimes about the number after which a counter wraps.
std::uint32_t pulses(const Module& module, Random& random) {
  const std::uint32_t wraps = module.runs_modbus() ? 65536 : 100000;
  return random.once_in(60) ? wraps - 2 + random.below(5) : random.between(1, 5);
}

/// Returns a line format with a parity other than that of `format`. A module that uses `format` can determine
/// where each byte in the returned line format ends.
LineFormat another_format(LineFormat format, Random& random) {
  const LineFormat other_parity = format == LineFormat::k8E1 ? LineFormat::k8O1 : LineFormat::k8E1;
  const bool has_parity = format == LineFormat::k8E1 || format == LineFormat::k8O1;
  return random.once_in(2) ? other_parity : has_parity ? LineFormat::k8N2 : LineFormat::k8O1;
}

}  // namespace

unsigned baud_code_with(unsigned code, const Module& module, Random& random) {
  return code | (!module.has_extensions() || random.once_in(2) ? 0U : random.below(4) << 6);
}

std::vector<Step> first_steps(const Module& module, Random& random) {
  if (random.once_in(2)) {
    return {};
  }
  const auto send = [](const std::string& text) {
    const std::string line = text + "\r";
    return Send{Bytes(line.begin(), line.end())};
  };
  std::vector<Step> steps = {Init{true}, Reset{}};
  steps.emplace_back(send("%00" + hex(random.between(0x01, 0xF7), 2) + "40" +
                          hex(baud_code_with(random.between(0x03, 0x0A), module, random), 2) +
                          random.one_of<std::string>({"00", "40", "80", "C0"})));
  if (module.row().both_protocols) {
    steps.emplace_back(send(std::string("$00P") + random.one_of({'0', '1'})));
  }
  steps.emplace_back(Init{false});
  steps.emplace_back(Reset{});
  return steps;
}

Step next_step(const Module& module, Random& random) {
  if (!module.powered() && !random.once_in(3)) {
    return Power{true};
  }
  if (module.waits_for_reset() && random.once_in(30)) {
    return Reset{};
  }
  const unsigned what = random.below(200);
  if (what < 4) {
    return Reset{};
  }
  if (what < 6) {
    return Power{!module.powered()};
  }
  if (what < 10) {
    return Init{!module.init_asserted()};
  }
  if (what < 14) {
    return wait(module, random);
  }
  // Some steps use inputs that the model does not have; these steps have no effect.
  if (what < (module.row().inputs != 0 ? 40U : 15U)) {
    // Many of these steps use an input whose filter time is running, if there is one. Many others use input 0
    // or 1, because requests set the filters of inputs 0 and 1 more often than other filters.
    const std::optional<unsigned> settling = module.settling_input();
    const unsigned channel = settling && random.once_in(2) ? *settling
                             : random.once_in(2)           ? random.below(2)
                                                           : random.below(module.row().inputs > 8 ? 16 : 8);
    return random.once_in(2) ? Step(Input{channel, random.once_in(2)})
                             : Step(Pulse{channel, pulses(module, random)});
  }
  // Sometimes the master uses the other protocol by mistake.
  const bool mistaken = module.row().both_protocols && random.once_in(100);
  Bytes bytes =
      module.runs_modbus() != mistaken ? modbus_request(module, random) : dcon_request(module, random);
  if (random.once_in(60)) {
    return SendInAnotherFormat{another_format(module.format(), random), std::move(bytes)};
  }
  return Send{std::move(bytes), random.once_in(2)};
}

}  // namespace ex9000::reference
