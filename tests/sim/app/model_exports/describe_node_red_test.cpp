// Tests the requests in the flow for Node-RED against wire.md. node_red_test.py checks the form of the flow.
#include "sim/app/model_exports/formats.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ex9000::sim {
namespace {

using Json = nlohmann::json;

Json flow_of(const char* designation, const NetworkAddress& place = {}) {
  return Json::parse(node_red_flow(*find_model(designation), place));
}

/// Returns data type, address and quantity of each node of this type.
std::vector<std::string> asked(const Json& flow, const char* type) {
  std::vector<std::string> all;
  for (const Json& node : flow) {
    if (node.at("type") == type) {
      all.push_back(node.at("dataType").get<std::string>() + " " + node.at("adr").get<std::string>() + " " +
                    node.at("quantity").get<std::string>());
    }
  }
  return all;
}

Json first(const Json& flow, const char* key, const char* value) {
  const auto found = std::find_if(flow.begin(), flow.end(), [&](const Json& node) {
    return node.contains(key) && node.at(key) == value;
  });
  return found == flow.end() ? Json() : *found;
}

TEST(DescribeNodeRed, SendsRtuFramesOverTcpToTheGivenPort) {
  const Json client = first(flow_of("EX9042D-M", {{"gateway", 4001}, 0x0A}), "type", "modbus-client");
  EXPECT_EQ(client.at("tcpHost"), "gateway");
  EXPECT_EQ(client.at("tcpPort"), "4001");
  EXPECT_EQ(client.at("unit_id"), "10");
  EXPECT_EQ(client.at("tcpType"), "TELNET");
  EXPECT_EQ(client.at("parallelUnitIdsAllowed"), false);
}

TEST(DescribeNodeRed, OverModbusTcpOnlyTheTypeOfTheClientDiffers) {
  Json flow = flow_of("EX9042D-M", {{"gateway", 502}, 0x0A, true});
  const auto client = std::find_if(flow.begin(), flow.end(),
                                   [](const Json& node) { return node.at("type") == "modbus-client"; });
  ASSERT_NE(client, flow.end());
  EXPECT_EQ(client->at("tcpType"), "DEFAULT");
  EXPECT_EQ(client->at("tcpPort"), "502");
  client->at("tcpType") = "TELNET";
  EXPECT_EQ(flow, flow_of("EX9042D-M", {{"gateway", 502}, 0x0A}));
}

TEST(DescribeNodeRed, ReadsOutputsAndSafeValuesAndPowerOnValuesAndTheHostWatchdog) {
  EXPECT_EQ(asked(flow_of("EX9042D-M"), "modbus-read"),
            (std::vector<std::string>{"Coil 0 13", "Coil 128 13", "Coil 160 13", "Coil 260 1", "Coil 269 1",
                                      "HoldingRegister 488 1"}));
}

TEST(DescribeNodeRed, ReadsInputsLatchesCountersAndTheHostWatchdog) {
  EXPECT_EQ(asked(flow_of("EX9052D-M"), "modbus-read"),
            (std::vector<std::string>{"Coil 64 8", "Coil 96 8", "Coil 260 1", "Coil 269 1", "Input 0 8",
                                      "InputRegister 0 8", "HoldingRegister 488 1"}));
}

TEST(DescribeNodeRed, SwitchesEachOutputOnAndOff) {
  const Json flow = flow_of("EX9068AD-M");
  const std::vector<std::string> writes = asked(flow, "modbus-write");
  ASSERT_EQ(writes.size(), 9U);  // one for each output, and one that clears the timeout status
  EXPECT_EQ(writes[7], "Coil 7 1");
  EXPECT_EQ(writes[8], "Coil 269 1");
  const Json write = first(flow, "name", "Output 7");
  std::vector<std::string> injected;
  for (const Json& node : flow) {
    if (node.at("type") == "inject" && node.at("wires").at(0).at(0) == write.at("id")) {
      injected.push_back(node.at("name").get<std::string>() + " " + node.at("payload").get<std::string>());
    }
  }
  EXPECT_EQ(injected, (std::vector<std::string>{"on true", "off false"}));
}

TEST(DescribeNodeRed, HasAWriteForEveryClearCommand) {
  const std::vector<std::string> writes = asked(flow_of("EX9052D-M"), "modbus-write");
  EXPECT_EQ(writes,
            (std::vector<std::string>{"Coil 263 1", "Coil 269 1", "Coil 512 1", "Coil 513 1", "Coil 514 1",
                                      "Coil 515 1", "Coil 516 1", "Coil 517 1", "Coil 518 1", "Coil 519 1"}));
}

}  // namespace
}  // namespace ex9000::sim
