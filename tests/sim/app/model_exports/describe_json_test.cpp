// Tests the description of models in JSON, for programs. The expected commands, functions and addresses are
// from wire.md and firmware/extensions.md.
#include "sim/app/model_exports/formats.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace ex9000::sim {
namespace {

using Json = nlohmann::json;

Json all() { return Json::parse(json_of(all_models())); }

Json json_of_model(const char* designation) {
  return Json::parse(json_of({find_model(designation)})).at("models").at(0);
}

/// Returns the first of `objects` that has this value under this key; null if there is none.
Json with(const Json& objects, const char* key, const Json& value) {
  for (const Json& object : objects) {
    if (object.at(key) == value) {
      return object;
    }
  }
  return {};
}

/// Returns the first of `registers` with this id and this table; null if there is none.
Json in_table(const Json& registers, const char* id, const char* table) {
  for (const Json& each : registers) {
    if (each.at("id") == id && each.at("table") == table) {
      return each;
    }
  }
  return {};
}

TEST(DescribeJson, HasEveryModelAndTheFirmwaresVersion) {
  EXPECT_EQ(all().at("firmware"), "D01.00");
  EXPECT_EQ(all().at("models").size(), 21U);
  EXPECT_EQ(json_of_model("EX9060D").at("model"), "EX9060D");
}

TEST(DescribeJson, HasThePropertiesOfAModel) {
  const Json relays = json_of_model("EX9068D-M");
  EXPECT_EQ(relays.at("inputs"), 0);
  EXPECT_EQ(relays.at("outputs"), 8);
  EXPECT_EQ(relays.at("protocols"), Json({"ascii", "modbus-rtu"}));
  EXPECT_EQ(relays.at("modbus_code"), 0x9068);
  EXPECT_EQ(relays.at("factory_name"), "9068D-M");
  EXPECT_EQ(relays.at("longest_name"), 7);
  EXPECT_EQ(relays.at("first_data_byte"), "DO0-7");
  EXPECT_EQ(relays.at("second_data_byte"), "00");
  EXPECT_EQ(relays.at("status_readings"), "00, 04");
  const Json mixed = json_of_model("EX9063D");
  EXPECT_EQ(mixed.at("protocols"), Json::array({"ascii"}));
  EXPECT_TRUE(mixed.at("modbus_code").is_null());
  EXPECT_EQ(mixed.at("first_data_byte"), "DO0-2");
  EXPECT_EQ(mixed.at("second_data_byte"), "DI0-7");
}

TEST(DescribeJson, HasAModelsCommands) {
  const Json commands = json_of_model("EX9052D-M").at("dcon_commands");
  EXPECT_EQ(commands.size(), 25U);
  const Json protocol = with(commands, "command", "$AAPN");
  EXPECT_EQ(protocol.at("reply"), "!AA");
  EXPECT_EQ(protocol.at("access"), "stored");
  EXPECT_EQ(protocol.at("needs_init"), true);
  const Json sample = with(commands, "command", "#**");
  EXPECT_TRUE(sample.at("reply").is_null());
  EXPECT_TRUE(sample.at("arguments").is_null());
  EXPECT_EQ(sample.at("needs_init"), false);
  EXPECT_EQ(with(commands, "command", "$AALS").at("access"), "read");
  EXPECT_TRUE(with(commands, "command", "@AA(Data)").is_null());
  EXPECT_TRUE(with(json_of_model("EX9052D").at("dcon_commands"), "command", "$AAP").is_null());
}

TEST(DescribeJson, HasAModelsFunctions) {
  const Json functions = json_of_model("EX9043D-M").at("modbus_functions");
  EXPECT_EQ(functions.size(), 11U);
  EXPECT_TRUE(with(functions, "code", 2).is_null());
  EXPECT_EQ(with(functions, "code", 0x0F).at("by_broadcast"), true);
  EXPECT_EQ(with(functions, "code", 0x46).at("by_broadcast"), false);
  EXPECT_EQ(with(json_of_model("EX9052D-M").at("modbus_functions"), "code", 2).at("name"),
            "Read Discrete Inputs");
  EXPECT_EQ(json_of_model("EX9043D").at("modbus_functions"), Json::array());
}

TEST(DescribeJson, HasAModelsRegisters) {
  const Json registers = json_of_model("EX9043D-M").at("modbus_registers");
  const Json outputs = in_table(registers, "outputs", "coil");
  EXPECT_EQ(outputs.at("first"), 0);
  EXPECT_EQ(outputs.at("last"), 0x0F);
  EXPECT_EQ(outputs.at("plc_first"), "00001");
  EXPECT_EQ(outputs.at("plc_last"), "00016");
  EXPECT_EQ(outputs.at("functions"), Json({1, 5, 15}));
  EXPECT_EQ(outputs.at("access"), "read, write");
  EXPECT_EQ(in_table(registers, "power-on-value", "coil").at("last"), 0xAF);
  const Json timeout = in_table(registers, "watchdog-timeout", "holding register");
  EXPECT_EQ(timeout.at("first"), 0x01E8);
  EXPECT_EQ(timeout.at("functions"), Json({3, 6, 16}));
  EXPECT_EQ(json_of_model("EX9043D").at("modbus_registers"), Json::array());
}

TEST(DescribeJson, MarksReadOnlyAndWriteOnlyRegisters) {
  const Json registers = json_of_model("EX9052D-M").at("modbus_registers");
  const Json counters = in_table(registers, "counters", "input register");
  EXPECT_EQ(counters.at("last"), 7);
  EXPECT_EQ(counters.at("functions"), Json::array({4}));
  EXPECT_EQ(counters.at("access"), "read");
  EXPECT_TRUE(counters.at("range").is_null());
  const Json clear = in_table(registers, "clear-latches", "coil");
  EXPECT_EQ(clear.at("first"), 0x0107);
  EXPECT_EQ(clear.at("functions"), Json::array({5}));
  EXPECT_EQ(clear.at("access"), "write");
  EXPECT_EQ(clear.at("range"), "1 only");
}

}  // namespace
}  // namespace ex9000::sim
