// Tests the channels in the template for wb-mqtt-serial against wire.md. wb_mqtt_serial_test.py checks the
// form of the template.
#include "sim/app/model_exports/formats.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace ex9000::sim {
namespace {

using Json = nlohmann::json;

Json template_of(const char* designation) {
  return Json::parse(wb_mqtt_serial_template(*find_model(designation)));
}

Json channel(const char* designation, const char* name) {
  const Json device = template_of(designation).at("device");
  for (const Json& each : device.at("channels")) {
    if (each.at("name") == name) {
      return each;
    }
  }
  return {};
}

TEST(DescribeWbMqttSerial, IsNamedAfterItsModel) {
  const Json all = template_of("EX9068AD-M");
  EXPECT_EQ(all.at("title"), "EX9068AD-M, 8 PhotoMOS outputs");
  EXPECT_EQ(all.at("device_type"), "EX9068AD-M");
  EXPECT_EQ(all.at("device").at("name"), "EX9068AD-M");
  EXPECT_EQ(all.at("device").at("id"), "ex9068ad_m");
}

TEST(DescribeWbMqttSerial, SetsMaxReadRegistersAndTheGuardInterval) {
  EXPECT_EQ(template_of("EX9043D-M").at("device").at("max_read_registers"), 16);
  EXPECT_EQ(template_of("EX9052D-M").at("device").at("max_read_registers"), 8);
  EXPECT_EQ(template_of("EX9052D-M").at("device").at("guard_interval_us"), 4010);  // 38.5 bits at 9600 baud
}

TEST(DescribeWbMqttSerial, OutputsAreSwitches) {
  EXPECT_EQ(channel("EX9042D-M", "Output 12"), (Json{{"name", "Output 12"},
                                                     {"id", "outputs_12"},
                                                     {"reg_type", "coil"},
                                                     {"address", 12},
                                                     {"type", "switch"}}));
  EXPECT_TRUE(channel("EX9042D-M", "Output 13").is_null());
}

TEST(DescribeWbMqttSerial, PowerOnValuesAreReadOnlyAndDisabledByDefault) {
  const Json preset = channel("EX9042D-M", "Power-on value 12");
  EXPECT_EQ(preset.at("address"), 0xAC);
  EXPECT_EQ(preset.at("enabled"), false);
  EXPECT_EQ(preset.at("readonly"), true);
}

TEST(DescribeWbMqttSerial, InputsAndCountersAreReadOnly) {
  EXPECT_EQ(channel("EX9052D-M", "Input 7"), (Json{{"name", "Input 7"},
                                                   {"id", "inputs_7"},
                                                   {"reg_type", "discrete"},
                                                   {"address", 7},
                                                   {"type", "switch"},
                                                   {"readonly", true}}));
  EXPECT_EQ(channel("EX9052D-M", "Counter 7"), (Json{{"name", "Counter 7"},
                                                     {"id", "counters_7"},
                                                     {"reg_type", "input"},
                                                     {"address", 7},
                                                     {"type", "value"},
                                                     {"format", "u16"},
                                                     {"readonly", true}}));
  EXPECT_EQ(channel("EX9052D-M", "Latch high 0").at("address"), 0x40);
}

TEST(DescribeWbMqttSerial, ClearCommandsAreWriteOnlyPushbuttons) {
  EXPECT_EQ(channel("EX9052D-M", "Clear counter 7"), (Json{{"name", "Clear counter 7"},
                                                           {"id", "clear_counters_7"},
                                                           {"reg_type", "coil"},
                                                           {"write_address", 0x0207},
                                                           {"type", "pushbutton"}}));
  EXPECT_EQ(channel("EX9043D-M", "Clear timeout status").at("write_address"), 0x010D);
}

TEST(DescribeWbMqttSerial, TheHostWatchdogIsShown) {
  EXPECT_EQ(channel("EX9043D-M", "Host watchdog timeout status").at("type"), "alarm");
  const Json timeout = channel("EX9043D-M", "Host watchdog timeout");
  EXPECT_EQ(timeout.at("address"), 0x01E8);
  EXPECT_EQ(timeout.at("scale"), 0.1);
  EXPECT_EQ(timeout.at("units"), "s");
}

}  // namespace
}  // namespace ex9000::sim
