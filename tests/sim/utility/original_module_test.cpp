// The utility with a module of the original maker: it has what the manuals say, and refuses the extensions.
#include <gtest/gtest.h>

#include "sim/utility/modbus/master.hpp"
#include "tests/sim/utility/plant.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::utility {
namespace {

constexpr std::uint8_t kIllegalFunction = 1;
constexpr std::uint8_t kIllegalAddress = 2;

std::optional<Data> exception(const Data& frame, std::uint8_t code) {
  Data reply{frame[0], static_cast<std::uint8_t>(frame[1] | kExceptionBit), code};
  append_crc(reply);
  return reply;
}

/// Manuals 3.1 to 3.3: functions 01 to 06, 0F, 10 and 46; the registers 0x0000 to 0x000F and 0x01E2 to
/// 0x01E8, and coils up to 0x020F.
std::optional<Data> original(const Data& frame) {
  if (frame[0] == 0xFD) {  // of no module
    return Data{};
  }
  if (frame[0] > 2) {
    return frame.size() > 3 && frame[0] == '~' && frame[3] == 'X'
               ? std::optional(Data{'?', frame[1], frame[2], '\r'})
               : std::nullopt;
  }
  const std::uint8_t function = frame[1];
  const bool bits = function == 0x01 || function == 0x02 || function == 0x05 || function == 0x0F;
  const bool words = function == 0x03 || function == 0x04 || function == 0x06 || function == 0x10;
  if (bits || words) {
    const unsigned address = Bytes{frame.data(), frame.size()}.word(2);
    const bool known = bits ? address < 0x0210 : address < 0x0010 || (address >= 0x01E2 && address <= 0x01E8);
    return known ? std::nullopt : exception(frame, kIllegalAddress);
  }
  return function == 0x46 ? std::nullopt : exception(frame, kIllegalFunction);
}

class OriginalModule : public testing::Test {
 protected:
  OriginalModule() { plant_.replies = original; }

  void run(const std::vector<std::string>& words, const std::string& output) {
    EXPECT_EQ(plant_.run(words), 0) << plant_.error();
    EXPECT_EQ(plant_.output(), output);
  }

  Plant plant_{{"EX9042D-M@01", "EX9052D@02"}};
  const system::Directory directory_;
};

TEST_F(OriginalModule, IsFound) {
  run({"scan", "port", "--baud", "9600", "--format", "8N1", "--addresses", "1-2"},
      "1 (01)  modbus 9600 baud 8N1  EX9042D-M ''\n"
      "2 (02)  ascii 9600 baud 8N1  EX9052D '9052'  D01.00\n");
}

TEST_F(OriginalModule, IsShown) {
  run({"show", "port", "1"}, R"(EX9042D-M '', Modbus at 9600 baud 8N1
settings
  protocol          modbus
  baud              9600
  format            8N1
  power-on-value    0000
  safe-value        0000
  watchdog-timeout  25.5s
  address           1
  watchdog          off
state
  outputs           0000
  timeout status    clear
)");
  run({"show", "port", "2"}, R"(EX9052D '9052', firmware D01.00, ASCII at 9600 baud 8N1
settings
  baud              9600
  format            8N1
  checksum          off
  name              9052
  edge              falling
  watchdog-timeout  25.5s
  address           2
  watchdog          off
state
  inputs            00
  latch high        00
  latch low         00
  counters          0 0 0 0 0 0 0 0
  timeout status    clear
)");
}

TEST_F(OriginalModule, IsSetSavedAndRestored) {
  const std::string file = directory_ / "module.yaml";
  run({"save", "port", "1,2", file}, "1: EX9042D-M, 8 settings\n2: EX9052D, 8 settings\n");
  run({"set", "port", "1", "safe-value=3", "watchdog-timeout=5s"},
      "safe-value: 0000 -> 0003; also switches the outputs to this value now\nwatchdog-timeout: 25.5s -> "
      "5s\n");
  run({"set", "port", "2", "edge=rising"},
      "edge: falling -> rising, in force from the next reset on\nswitch the module off and on\n");
  run({"restore", "port", "1", file},
      "safe-value: 0003 -> 0000; also switches the outputs to this value now\nwatchdog-timeout: 5s -> "
      "25.5s\n");
  run({"restore", "port", "2", file},
      "edge: rising -> falling, in force from the next reset on\nswitch the module off and on\n");
  EXPECT_EQ(plant_.run({"set", "port", "1", "response-delay=5"}), 1);
  EXPECT_EQ(plant_.error(),
            "ex9000: response-delay: does not have this: exception 02 (illegal data address)\n");
}

}  // namespace
}  // namespace ex9000::utility
