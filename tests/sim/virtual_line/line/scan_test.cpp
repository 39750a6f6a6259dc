// Tests that a scan finds every module of a line once, in ascending order of the serial numbers, and that a
// request by serial number reaches one module: extensions.md, scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "sim/notation/module_notation.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/sim/virtual_line/line/scan_master.hpp"

namespace ex9000::sim {
namespace {

std::vector<ModuleSpec> plant(std::mt19937& random, std::size_t size, std::uint8_t baud_code) {
  std::vector<ModuleSpec> modules;
  std::set<std::uint16_t> used;
  while (modules.size() < size) {
    ModuleSpec spec = parse_module_spec("EX9042D-M@01,protocol=modbus");
    const auto low = static_cast<std::uint16_t>(random());
    if (!used.insert(low).second) {
      continue;
    }
    spec.serial_number = 0x0D000000 + low;
    spec.settings.address = static_cast<std::uint8_t>(1 + random() % 247);
    spec.settings.baud_code = baud_code;
    modules.push_back(spec);
  }
  return modules;
}

TEST(Scan, FindsEveryModuleOnceInOrder) {
  std::mt19937 random(1);
  for (const unsigned format : {0x00U, 0x40U, 0x80U, 0xC0U}) {
    for (std::uint8_t rate = 3; rate <= 10; ++rate) {
      const std::size_t size = 1 + random() % 12;
      const auto modules = plant(random, size, static_cast<std::uint8_t>(format | rate));
      ScanMaster master(modules);
      std::vector<ScanMaster::Found> expected;
      for (const ModuleSpec& module : modules) {
        expected.push_back({module.serial_number, module.settings.address});
      }
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(master.scan(), expected) << hex_byte_text(static_cast<std::uint8_t>(format | rate));
    }
  }
}

}  // namespace
}  // namespace ex9000::sim
