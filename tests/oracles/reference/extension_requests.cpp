// Addresses and values for requests to extension registers, in and out of range: extensions.md.
#include <optional>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/extension_registers.hpp"
#include "tests/oracles/reference/generator.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::reference {

namespace {

/// Returns the address of a setting that is a number.
unsigned setting_address(const ModelRow& model, Random& random) {
  std::vector<unsigned> addresses;
  for (const ExtensionRow& row : extension_rows(model)) {
    if (row.setting != nullptr && row.count != 0) {
      addresses.push_back(row.first);
    }
  }
  return addresses.at(random.below(static_cast<unsigned>(addresses.size())));
}

}  // namespace

unsigned extension_address(const Module& module, Random& random) {
  const std::optional<unsigned> settling = module.settling_input();
  if (settling && random.once_in(3)) {
    return 0x0240 + *settling;
  }
  const unsigned inputs = module.row().inputs;
  if (inputs != 0 && random.once_in(3)) {
    const unsigned channel = random.once_in(2) ? random.below(2) : random.below(inputs + 1);
    return random.one_of(
        {0x0240 + channel, 0x0240 + channel, 0x0250U, 0x0260 + 2 * channel, 0x0261 + 2 * channel});
  }
  if (module.row().outputs != 0 && random.once_in(3)) {
    const unsigned channel = random.once_in(2) ? random.below(2) : random.below(module.row().outputs + 1);
    return 0x0280 + channel;
  }
  switch (random.below(12)) {
    case 0:  // at the ends of rows, in holes, and outside the table
      return random.one_of({0x023FU, 0x0240U, 0x024FU, 0x0250U, 0x0253U, 0x025FU, 0x0260U, 0x027FU, 0x0280U,
                            0x0290U, 0x02FFU, 0x0307U, 0x0310U, 0x0311U});
    case 1:
    case 2:
      return random.one_of({0x0301U, 0x0301U, 0x0302U, 0x0304U, 0x0304U, 0x0305U, 0x0306U, 0x0250U});
    case 3:
    case 4:
    case 5:
      return setting_address(module.row(), random);
    default:
      return 0x0300 + random.below(0x10);
  }
}

unsigned extension_content(const Module& module, unsigned address, Random& random) {
  if (random.once_in(8)) {
    return random.below(0x10000);
  }
  const ExtensionRow row = extension_row(module.row(), address);
  switch (row.row) {
    case Extension::InputFilters:
      return random.one_of({0U, 1U, 20U, 100U, 500U, 1000U, 2000U, 2000U, 2001U});
    case Extension::Inversion:
      return random.once_in(3) ? module.stored().inversion
                               : random.below(1U << module.row().inputs) << random.below(2);
    case Extension::Setting:
      return random.between(0, row.highest + 1);
    case Extension::TimedOutputs:
      return random.one_of({0U, 1U, 2U, 5U, 10U, 20U, 50U, 100U, 1000U, 0xFFFFU});
    case Extension::Timeouts:
      return random.once_in(3) ? random.one_of({1U, 0x0100U, 0xFFFFU}) : 0;
    default:
      return random.below(3);
  }
}

Bytes filter_request(const Module& module, unsigned channel, Random& random) {
  const unsigned address = 0x0240 + channel;
  const unsigned time = extension_content(module, address, random);
  if (module.runs_modbus()) {
    Bytes frame{static_cast<std::uint8_t>(module.address()), 0x06};
    append_word(frame, address);
    append_word(frame, time);
    return with_crc(frame);
  }
  const std::string command = "~" + hex(module.address(), 2) + "X" + hex(address, 4) + hex(time, 4);
  const std::string line = command + (module.checksum() ? check_of(command) : "") + "\r";
  return Bytes(line.begin(), line.end());
}

}  // namespace ex9000::reference
