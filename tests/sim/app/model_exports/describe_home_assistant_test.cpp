// Tests the content of the hub for Home Assistant. The expected addresses are from wire.md and
// firmware/extensions.md. home_assistant_test.py checks the form of the hub.
#include "sim/app/model_exports/formats.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace ex9000::sim {
namespace {

std::string configuration_of(const char* designation, const NetworkAddress& place = {}) {
  return home_assistant_hub(*find_model(designation), place);
}

std::ptrdiff_t times(const std::string& text, const std::string& part) {
  std::ptrdiff_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) {
    ++count;
  }
  return count;
}

bool has_once(const std::string& text, const std::string& part) { return times(text, part) == 1; }

TEST(DescribeHomeAssistant, UsesRtuOverTcpToTheGivenOrTheDefaultPort) {
  EXPECT_TRUE(has_once(configuration_of("EX9042D-M"),
                       "- name: ex9042d_m_01\n"
                       "  type: rtuovertcp\n"
                       "  host: \"127.0.0.1\"\n"
                       "  port: 5020\n"));
  EXPECT_TRUE(has_once(configuration_of("EX9042D-M", {{"gateway", 4001}, 0xF7}),
                       "- name: ex9042d_m_F7\n"
                       "  type: rtuovertcp\n"
                       "  host: gateway\n"
                       "  port: 4001\n"));
}

TEST(DescribeHomeAssistant, OverModbusTcpOnlyTheTypeOfTheHubDiffers) {
  std::string text = configuration_of("EX9042D-M", {{"gateway", 502}, 0xF7, true});
  EXPECT_TRUE(has_once(text,
                       "- name: ex9042d_m_F7\n"
                       "  type: tcp\n"
                       "  host: gateway\n"
                       "  port: 502\n"));
  text.replace(text.find("type: tcp"), std::string("type: tcp").size(), "type: rtuovertcp");
  EXPECT_EQ(text, configuration_of("EX9042D-M", {{"gateway", 502}, 0xF7}));
}

TEST(DescribeHomeAssistant, OutputsAreSwitchesThatAreReadBack) {
  const std::string text = configuration_of("EX9042D-M", {{}, 0x0A});
  EXPECT_EQ(times(text, "      write_type: coil\n"), 13);
  EXPECT_TRUE(has_once(text,
                       "    - name: EX9042D-M 0A Output 12\n"
                       "      unique_id: ex9042d_m_0A_outputs_12\n"
                       "      slave: 10\n"
                       "      address: 12\n"
                       "      scan_interval: 5\n"
                       "      write_type: coil\n"
                       "      verify:\n"
                       "        input_type: coil\n"
                       "        address: 12\n"));
  EXPECT_EQ(times(configuration_of("EX9052D-M"), "switches:"), 0);
}

TEST(DescribeHomeAssistant, InputsAndLatchesAreBinarySensors) {
  const std::string text = configuration_of("EX9052D-M");
  EXPECT_TRUE(has_once(text,
                       "    - name: EX9052D-M 01 Input\n"
                       "      unique_id: ex9052d_m_01_inputs\n"
                       "      slave: 1\n"
                       "      address: 0\n"
                       "      scan_interval: 5\n"
                       "      virtual_count: 7\n"
                       "      input_type: discrete_input\n"));
  EXPECT_TRUE(has_once(text,
                       "      unique_id: ex9052d_m_01_latch_low\n"
                       "      slave: 1\n"
                       "      address: 96\n"  // 0x60
                       "      scan_interval: 5\n"
                       "      virtual_count: 7\n"
                       "      input_type: coil\n"));
}

TEST(DescribeHomeAssistant, CountersAreSensorsWithTheStateClassTotalIncreasing) {
  EXPECT_TRUE(has_once(configuration_of("EX9052D-M"),
                       "    - name: EX9052D-M 01 Counter\n"
                       "      unique_id: ex9052d_m_01_counters\n"
                       "      slave: 1\n"
                       "      address: 0\n"
                       "      scan_interval: 5\n"
                       "      virtual_count: 7\n"
                       "      input_type: input\n"
                       "      data_type: uint16\n"
                       "      state_class: total_increasing\n"));
}

// A poll takes a request of 8 bytes, a reply of 5 bytes and its data, T3.5 before the reply (38.5 bits), and
// the 33 ms that Home Assistant waits. A byte has 10 bits.
TEST(DescribeHomeAssistant, StatesHowLongTheRequestsOfARoundTake) {
  // Three rows of 16 bits and 16 registers: 3 * 15 + 45 bytes are 94 ms; 4 silences and waits are 148 ms.
  // Two coils and a register: 14 + 14 + 15 bytes are 45 ms; 3 silences and waits are 111 ms.
  EXPECT_TRUE(
      has_once(configuration_of("EX9053D-M"),
               "# At 9600 baud, the 4 requests every 5 s take 0.24 s, and the 3 requests every 30 s take "
               "0.16 s. The sum for all modules of the hub must be less than 5 s.\n"));
  // 16 switches: 16 * 14 bytes are 233 ms; 16 silences and waits are 592 ms.
  EXPECT_TRUE(has_once(configuration_of("EX9043D-M"), "the 16 requests every 5 s take 0.83 s, "));
}

TEST(DescribeHomeAssistant, TheHostWatchdogIsShown) {
  const std::string text = configuration_of("EX9068D-M");
  EXPECT_TRUE(has_once(text,
                       "      unique_id: ex9068d_m_01_timeout_status\n"
                       "      slave: 1\n"
                       "      address: 269\n"  // 0x010D
                       "      scan_interval: 30\n"
                       "      input_type: coil\n"
                       "      device_class: problem\n"));
  EXPECT_TRUE(
      has_once(text, "      unique_id: ex9068d_m_01_watchdog_enable\n      slave: 1\n      address: 260\n"));
  EXPECT_TRUE(has_once(text,
                       "      address: 488\n"  // 0x01E8
                       "      scan_interval: 30\n"
                       "      input_type: holding\n"
                       "      data_type: uint16\n"
                       "      scale: 0.1\n"
                       "      precision: 1\n"
                       "      device_class: duration\n"
                       "      unit_of_measurement: s\n"));
}

TEST(DescribeHomeAssistant, ClearCommandsAreListedAsActions) {
  const std::string text = configuration_of("EX9052D-M", {{}, 0x02});
  EXPECT_TRUE(has_once(
      text,
      "#   Clear counter 7: modbus.write_coil with hub: ex9052d_m_02, slave: 2, address: 519, state: "
      "true\n"));  // 0x0207
  EXPECT_TRUE(
      has_once(text, "#   Clear latches: modbus.write_coil with hub: ex9052d_m_02, slave: 2, address: 263,"));
  EXPECT_EQ(times(configuration_of("EX9042D-M"), "Clear "), 1);
}

// Coils 0x0104 and 0x010D are in wire.md section 7, Map. Register 0x0251 is in firmware/extensions.md.
TEST(DescribeHomeAssistant, ExplainsHowPollsRestartTheHostWatchdogAndWhatClearsTheTimeoutStatus) {
  const std::string text = configuration_of("EX9042D-M", {{}, 0x02});
  const std::string to = " with hub: ex9042d_m_02, slave: 2, address: ";
  const std::size_t feed = text.find("#   modbus.write_register" + to +
                                     "593, value: 1\n#   modbus.write_coil" + to + "260, state: true\n");
  const std::size_t after = text.find("#   modbus.write_coil" + to +
                                      "269, state: true\n#   modbus.write_coil" + to + "260, state: true\n");
  EXPECT_NE(text.find("the module refuses to switch the outputs"), std::string::npos);
  // The EX9052D-M has no outputs.
  EXPECT_EQ(configuration_of("EX9052D-M").find("the outputs"), std::string::npos);
  ASSERT_NE(feed, std::string::npos) << text;
  ASSERT_NE(after, std::string::npos) << text;
  EXPECT_LT(feed, after);
}

TEST(DescribeHomeAssistant, DoesNotPollHostOkOrCommunicationSettingsOrCoilsThatClearCounters) {
  for (const char* model : {"EX9043D-M", "EX9052D-M"}) {
    for (const char* address :
         {"12344", "256", "484", "485", "512"}) {  // host OK, protocol, address, baud rate, clear counter 0
      EXPECT_EQ(times(configuration_of(model), "address: " + std::string(address) + "\n"), 0)
          << model << " " << address;
    }
  }
}

}  // namespace
}  // namespace ex9000::sim
