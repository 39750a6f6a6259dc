// Tests that the tables of models, commands, functions and registers are consistent.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "firmware/dcon/commands.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/model/model.hpp"
#include "firmware/registers/bits.hpp"
#include "firmware/registers/words.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {
namespace {

template <class Table, class Id>
void expect_unique(const Table& table, Id id) {
  std::set<std::string> seen;
  for (const auto& row : table) {
    EXPECT_TRUE(seen.insert(std::string(id(row))).second) << id(row);
  }
}

TEST(Tables, EveryRowHasItsOwnId) {
  expect_unique(kModels, [](const Model& row) { return row.designation; });
  expect_unique(dcon::kCommands, [](const dcon::Command& row) { return row.id; });
  expect_unique(dcon::kCommands, [](const dcon::Command& row) { return row.syntax; });
  expect_unique(registers::kBitRegisters, [](const registers::BitRegister& row) { return row.id; });
  expect_unique(registers::kWordRegisters, [](const registers::WordRegister& row) { return row.id; });
  expect_unique(modbus::kFunctions, [](const modbus::Function& row) { return row.name; });
}

TEST(Tables, EveryModelHasPossibleChannelsAndFactorySettingsAndTheCorrectModbusCode) {
  for (const Model& model : kModels) {
    EXPECT_LE(model.inputs, kMaxInputs) << model.designation;
    EXPECT_LE(model.outputs, kMaxOutputs) << model.designation;
    EXPECT_TRUE(model.has_inputs() || model.has_outputs()) << model.designation;
    EXPECT_TRUE(Settings::factory(model).possible_for(model)) << model.designation;
    // Only -M models have a Modbus code. The hex digits of the code are the four digits of the designation.
    const bool m = model.designation.substr(model.designation.size() - 2) == "-M";
    EXPECT_EQ(model.speaks_modbus(), m) << model.designation;
    if (m) {
      EXPECT_EQ(model.modbus_code, std::stoul(std::string(model.designation.substr(2, 4)), nullptr, 16));
    }
  }
}

TEST(Tables, TheSyntaxOfEveryCommandMatchesItsDispatch) {
  for (const dcon::Command& command : dcon::kCommands) {
    const dcon::Dispatch& row = command.dispatch;
    EXPECT_EQ(command.syntax[0], row.delimiter) << command.syntax;
    EXPECT_EQ(command.syntax.substr(1, 2), row.key == dcon::kBroadcastKey ? "**" : "AA") << command.syntax;
    if (row.key != dcon::kNoKey && row.key != dcon::kBroadcastKey) {
      EXPECT_EQ(command.syntax[3], row.key) << command.syntax;
    }
    EXPECT_LE(row.fewest_args, row.most_args) << command.syntax;
    EXPECT_NE(row.handler, nullptr) << command.syntax;
  }
}

TEST(Tables, RowsOfOneFunctionDoNotOverlapAndHaveTheRequiredHandler) {
  for (unsigned code = 1; code < 16; ++code) {
    const auto function = static_cast<registers::Functions>(1U << code);
    for (const Model& model : kModels) {
      std::set<unsigned> addresses;
      for (const registers::BitRegister& entry : registers::kBitRegisters) {
        if ((entry.row.functions & function) == 0 || !meets(model, entry.row.needs)) {
          continue;
        }
        const bool writes = (function & (registers::kWriteSingleCoil | registers::kWriteMultipleCoils)) != 0;
        EXPECT_TRUE(writes ? entry.row.write != nullptr : entry.row.read != nullptr) << entry.id;
        for (unsigned i = 0; i < registers::width_of(entry.row.width, model); ++i) {
          EXPECT_TRUE(addresses.insert(entry.row.first + i).second) << entry.id;
        }
      }
      for (const registers::WordRegister& entry : registers::kWordRegisters) {
        if ((entry.row.functions & function) == 0 || !meets(model, entry.row.needs)) {
          continue;
        }
        EXPECT_TRUE(function == registers::kWriteSingleRegister ? entry.row.write != nullptr
                                                                : entry.row.read != nullptr);
        for (unsigned i = 0; i < registers::width_of(entry.row.width, model); ++i) {
          EXPECT_TRUE(addresses.insert(entry.row.first + i).second) << entry.id;
        }
      }
    }
  }
}

}  // namespace
}  // namespace ex9000
