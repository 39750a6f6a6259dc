// Tests the data of all exports against firmware/wire.md. map_test.cpp compares the map with the reference.
#include "sim/app/exports/description.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

namespace ex9000::sim {
namespace {

using Json = nlohmann::ordered_json;

Json described(const char* designation) { return description({find_model(designation)}).at("models").at(0); }

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

// describe_test.cpp compares the properties that registers.md shows.
TEST(Description, HasPropertiesThatRegistersMdDoesNotShow) {
  const Json relays = described("EX9068D-M");
  EXPECT_EQ(relays.at("protocols"), Json::array({"ascii", "modbus-rtu"}));
  EXPECT_EQ(relays.at("modbus_code"), 0x9068);
  EXPECT_EQ(relays.at("longest_name"), 7);
  EXPECT_EQ(described("EX9063D").at("longest_name"), 6);
  EXPECT_EQ(described("EX9063D").at("modbus_registers"), Json::array());
}

// wire.md section 1: if a model has more than eight outputs, its data byte First contains DO8 and the higher
// outputs.
TEST(Description, ASingleChannelInADataByteIsNotShownAsARange) {
  Model model = *find_model("EX9042D-M");
  model.outputs = 9;
  const Json described = description({&model}).at("models").at(0);
  EXPECT_EQ(described.at("first_data_byte"), "DO8");
  EXPECT_EQ(described.at("second_data_byte"), "DO0-7");
}

std::set<std::string> commands(const Model& model) {
  std::set<std::string> all;
  const Json described = description({&model});
  for (const Json& command : described.at("dcon_commands")) {
    all.insert(command.at("command"));
  }
  return all;
}

// wire.md section 4
TEST(Description, AModelHasTheCommandsThatSuitItsChannelsAndProtocols) {
  const std::set<std::string> with_outputs{"#AABBDD", "@AA(Data)", "~AA4V", "~AA5V"};
  const std::set<std::string> with_inputs{"#AAN", "$AAC", "$AACN", "$AALS"};
  const std::set<std::string> with_modbus{"$AAP", "$AAPN"};
  const std::set<std::string> all = commands(*find_model("EX9060D-M"));  // has inputs, outputs and Modbus
  EXPECT_EQ(all.size(), 29U);
  for (const Model& model : kModels) {
    std::set<std::string> wanted = all;
    for (const auto& [has, some] :
         {std::pair(model.has_outputs(), with_outputs), std::pair(model.has_inputs(), with_inputs),
          std::pair(model.speaks_modbus(), with_modbus)}) {
      for (const std::string& command : some) {
        EXPECT_EQ(all.count(command), 1U) << command;
        if (!has) {
          wanted.erase(command);
        }
      }
    }
    EXPECT_EQ(commands(model), wanted) << model.designation;
  }
}

TEST(Description, PlcNumbersCountFrom1AfterTheDigitOfTheirTable) {
  const Json map = described("EX9060D-M").at("modbus_registers");
  const Json latches = in_table(map, "latch-low", "coil");  // 0x0060
  EXPECT_EQ(latches.at("plc_first"), "00097");
  EXPECT_EQ(latches.at("plc_last"), "00100");
  EXPECT_EQ(latches.at("items").at(3), Json({{"address", 0x0063}, {"plc_number", "00100"}, {"channel", 3}}));
  EXPECT_EQ(in_table(map, "inputs", "discrete input").at("plc_first"), "10001");
  EXPECT_EQ(in_table(map, "counters", "input register").at("plc_last"), "30004");
  EXPECT_EQ(in_table(map, "address", "holding register").at("plc_first"), "40485");
  EXPECT_EQ(in_table(map, "host-ok", "holding register").at("plc_first"), "412345");
}

// Templates print these texts in cells of Markdown and CSV and in quotes, and escape nothing.
TEST(Description, TextsHaveNoCharacterThatAFormatWouldHaveToEscape) {
  const std::string all = description(all_models()).dump();
  EXPECT_EQ(all.find_first_of("|\\"),
            std::string::npos);  // dump() escapes quotes and line breaks with a backslash
}

// --- entities ---

TEST(Description, EntitiesHaveUniqueNamesAndKeys) {
  for (const Model* model : all_models()) {
    std::set<std::string> names;
    std::set<std::string> keys;
    std::size_t count = 0;
    const Json described = description({model});
    for (const Json& entity : described.at("models").at(0).at("entities")) {
      for (const Json& channel : entity.at("channels")) {
        names.insert(channel.at("name"));
        keys.insert(channel.at("key"));
        ++count;
      }
    }
    EXPECT_EQ(names.size(), count) << model->designation;
    EXPECT_EQ(keys.size(), count) << model->designation;
    EXPECT_EQ(count == 0, !model->speaks_modbus());
  }
}

TEST(Description, AnEntityHasItsChannels) {
  const Json entities = described("EX9052D-M").at("entities");
  const Json clear = with(entities, "name", "Clear counter");
  EXPECT_EQ(clear.at("role"), "button");
  EXPECT_EQ(clear.at("channels").at(7).at("name"), "Clear counter 7");
  EXPECT_EQ(clear.at("channels").at(7).at("key"), "clear_counter_7");
  EXPECT_EQ(clear.at("channels").at(7).at("address"), 0x0207);
  const Json status = with(entities, "name", "Host watchdog timeout status");
  EXPECT_EQ(status.at("role"), "problem");
  EXPECT_EQ(status.at("channels").size(), 1U);
  EXPECT_EQ(status.at("channels").at(0).at("key"), "host_watchdog_timeout_status");
  EXPECT_EQ(with(entities, "name", "Counter").at("table"),
            "input register");  // and not also the holding registers
}

TEST(Description, RowsCountTheEntitiesAndTheChannelsThatToolsWrite) {
  const Json entities = described("EX9060D-M").at("entities");
  unsigned entity_rows = 0;
  unsigned channel_rows = 0;
  for (const Json& entity : entities) {
    EXPECT_EQ(entity.at("row"), ++entity_rows);
    const bool is_written = entity.at("role") == "output" || entity.at("role") == "button";
    for (const Json& channel : entity.at("channels")) {
      EXPECT_EQ(channel.at("row"), is_written ? Json(++channel_rows) : Json()) << channel;
    }
  }
  EXPECT_EQ(channel_rows, 4U + 4 + 2);  // outputs, counters, latches and timeout status
}

}  // namespace
}  // namespace ex9000::sim
