// Tests that a module ignores requests for other addresses: it sends no reply, drives no output and stores
// nothing. The tests combine every other address with every DCON command and with every Modbus function code.
// They send no broadcasts.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "firmware/dcon/commands.hpp"
#include "sim/text/values.hpp"
#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;

constexpr unsigned kOwnAddress = 0x35;

/// Returns arguments for the command. Their form is valid on those models of this test that have the command.
/// Exception: the arguments for the commands of firmware/extensions.md may have a wrong form.
std::string arguments(const dcon::Command& command) {
  if (command.id == "set-configuration") {
    return "02400600";
  }
  if (command.id == "set-output-group") {
    return "00FF";
  }
  if (command.id == "set-outputs") {
    return "FF";
  }
  if (command.id == "set-watchdog") {
    return "105";
  }
  if (command.id == "set-name") {
    return "NAME";
  }
  if (command.id == "read-preset-value" || command.id == "store-preset-value") {
    return "P";
  }
  return command.dispatch.most_args == 0 ? "" : "0";
}

void expect_untouched(ModuleBench& bench, const Settings& settings, std::uint64_t writes) {
  EXPECT_TRUE(bench.recorder().sent_by(1).empty());
  EXPECT_EQ(bench.module().outputs(), 0);
  EXPECT_EQ(bench.module().memory().writes(), writes);
  EXPECT_TRUE(bench.module().module().state().settings == settings);
}

void every_command_to_every_other_address(const char* model) {
  ModuleBench bench(std::string(model) + "@35,protocol=ascii,baud=115200");
  const Settings settings = bench.module().module().state().settings;
  for (unsigned address = 0; address <= 0xFF; ++address) {
    for (const dcon::Command& command : dcon::kCommands) {
      if (address == kOwnAddress || command.dispatch.key == dcon::kBroadcastKey) {
        continue;
      }
      const std::string key =
          command.dispatch.key == dcon::kNoKey ? "" : std::string(1, command.dispatch.key);
      bench.send(command.dispatch.delimiter + hex_byte_text(address) + key + arguments(command) + "\r");
      bench.run(std::chrono::milliseconds(5));
    }
  }
  bench.run(std::chrono::milliseconds(300));
  expect_untouched(bench, settings, 0);
  EXPECT_NE(bench.ask("$352"), "") << "the module must still receive";
}

TEST(ForeignAddress, CommandsToOtherAddressesAreIgnored) {
  every_command_to_every_other_address("EX9055D");
  every_command_to_every_other_address("EX9042D-M");
}

void every_function_to_every_other_address(const char* model) {
  ModuleBench bench(std::string(model) + "@35,baud=115200");
  const Settings settings = bench.module().module().state().settings;
  for (unsigned address = 1; address <= 0xFF; ++address) {
    for (unsigned function = 0; function <= 0xFF; ++function) {
      if (address == kOwnAddress) {
        continue;
      }
      // With function 05, this data switches coil 0x0000 on. With many other functions, the request is
      // invalid. The module must ignore both valid and invalid requests for other addresses.
      Bytes frame{static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(function), 0, 0, 0xFF, 0};
      if (function == 0x0F) {
        frame = {frame[0], frame[1], 0, 0, 0, 8, 1, 0xFF};
      } else if (function == 0x46) {
        frame = {frame[0], frame[1], 4, 9, 0, 0, 0};
      }
      bench.send(with_crc(frame));
      bench.run(std::chrono::milliseconds(3));
    }
  }
  bench.run(std::chrono::milliseconds(300));
  expect_untouched(bench, settings, 0);
  EXPECT_FALSE(bench.ask(Bytes{kOwnAddress, 0x11}).empty()) << "the module must still receive";
}

TEST(ForeignAddress, FunctionCodesToOtherAddressesAreIgnored) {
  every_function_to_every_other_address("EX9042D-M");
  every_function_to_every_other_address("EX9052D-M");
}

}  // namespace
}  // namespace ex9000::sim
