// Tests the simulator with unmodified libmodbus, on one line with two modules. Uses every function for which
// libmodbus has a call. The expected values are from firmware/wire.md 7. The expected exceptions of the
// gateway are from sim/docs/integrations.md.
#include <gtest/gtest.h>
#include <modbus/modbus.h>

#include <array>
#include <cerrno>
#include <functional>
#include <string>
#include <vector>

#include "tests/masters/libmodbus_master.hpp"
#include "tests/support/two_modules.hpp"

namespace ex9000::system {
namespace {

using Bits = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;

constexpr int kOutputs = 1;  // the address of an EX9042D-M
constexpr int kInputs = 2;   // the address of an EX9052D-M
constexpr int kBroadcast = 0;

constexpr int kSafe = 0x0080;
constexpr int kPowerOn = 0x00A0;
constexpr int kWatchdogEnable = 0x0104;
constexpr int kTimeoutStatus = 0x010D;
constexpr int kCode = 0x01E2;
constexpr int kAddress = 0x01E4;
constexpr int kTimeout = 0x01E8;
constexpr int kHostOk = 0x3038;

class Libmodbus : public testing::TestWithParam<Way> {
 protected:
  Bits coils(int address, int first, int count) {
    return read<Bits>(modbus_read_bits, address, first, count);
  }
  Bits inputs(int address, int first, int count) {
    return read<Bits>(modbus_read_input_bits, address, first, count);
  }
  Words registers(int address, int first, int count) {
    return read<Words>(modbus_read_registers, address, first, count);
  }
  Words input_registers(int address, int first, int count) {
    return read<Words>(modbus_read_input_registers, address, first, count);
  }
  int write_coils(int address, int first, const Bits& values) {
    return modbus_write_bits(master_.at(address), first, static_cast<int>(values.size()), values.data());
  }
  int write_registers(int address, int first, const Words& values) {
    return modbus_write_registers(master_.at(address), first, static_cast<int>(values.size()), values.data());
  }

  static bool over_modbus_tcp() { return GetParam().port == Way::ModbusTcp; }

  TwoModules modules_{GetParam()};
  LibmodbusMaster master_ = over_modbus_tcp() ? LibmodbusMaster(modules_.modbus_tcp_port())
                                              : LibmodbusMaster(modules_.tty(), GetParam().baud);

 private:
  template <typename Values, typename Function>
  Values read(Function function, int address, int first, int count) {
    Values values(static_cast<std::size_t>(count));
    const int got = function(master_.at(address), first, count, values.data());
    EXPECT_EQ(got, count) << modbus_strerror(errno);
    return values;
  }
};

TEST_P(Libmodbus, GetsTheRepliesOfTwoModulesThatItPollsInTurn) {
  for (int i = 0; i < 50; ++i) {
    const int channel = i % 13;
    ASSERT_EQ(modbus_write_bit(master_.at(kOutputs), channel, 1), 1) << modbus_strerror(errno);
    EXPECT_EQ(inputs(kInputs, 0, 8), Bits(8, 0));
    EXPECT_EQ(coils(kOutputs, channel, 1), Bits{1});
    EXPECT_EQ(registers(kInputs, kCode, 2), (Words{0x0090, 0x5200}));
  }
}

TEST_P(Libmodbus, ReadsBackTheValuesThatItHasWrittenAndReadsTheServerIds) {
  const Bits pattern{1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 1, 0, 1};
  EXPECT_EQ(write_coils(kOutputs, 0, pattern), 13);
  EXPECT_EQ(input_registers(kInputs, 0, 8), Words(8, 0));
  EXPECT_EQ(coils(kOutputs, 0, 13), pattern);
  EXPECT_EQ(registers(kInputs, 6, 2), Words(2, 0));
  EXPECT_EQ(modbus_write_bit(master_.at(kOutputs), 12, 0), 1);
  EXPECT_EQ(coils(kInputs, 0x0020, 8), Bits(8, 0));
  EXPECT_EQ(coils(kOutputs, 11, 2), Bits(2, 0));
  EXPECT_EQ(write_coils(kInputs, 0x0200, Bits(8, 1)), 8);
  EXPECT_EQ(modbus_write_bit(master_.at(kOutputs), kSafe + 1, 1), 1);
  EXPECT_EQ(modbus_write_bit(master_.at(kInputs), 0x0107, 1), 1);
  EXPECT_EQ(write_coils(kOutputs, kPowerOn + 4, {1, 1}), 2);
  EXPECT_EQ(coils(kOutputs, 0, 8), (Bits{1, 1, 1, 1, 1, 1, 1, 0}))
      << "writes of the safe value and of the power-on value also drive the outputs";

  EXPECT_EQ(modbus_write_register(master_.at(kInputs), kTimeout, 100), 1);
  EXPECT_EQ(write_registers(kOutputs, kAddress, {9, 7}), 2);
  EXPECT_EQ(registers(kInputs, kTimeout, 1), Words{100});
  EXPECT_EQ(registers(kOutputs, kCode, 4), (Words{0x0090, 0x4200, 9, 7}));

  std::array<std::uint8_t, 64> id{};
  const auto size = static_cast<int>(id.size());
  EXPECT_EQ(modbus_report_slave_id(master_.at(kOutputs), size, id.data()), 8);
  EXPECT_EQ(std::string(id.begin(), id.begin() + 8),
            "\x90\x42\xFF"
            "9042M");
  EXPECT_EQ(modbus_report_slave_id(master_.at(kInputs), size, id.data()), 8);
  EXPECT_EQ(std::string(id.begin(), id.begin() + 8),
            "\x90\x52\xFF"
            "9052M");
}

bool fails_with(int error, int result) {
  EXPECT_EQ(result, -1);
  EXPECT_EQ(errno, error) << modbus_strerror(errno);
  return result == -1 && errno == error;
}

TEST_P(Libmodbus, BroadcastsAndHostOkHaveNoReply) {
  // The line runs in real time. If a request came before the simulator has read the previous one, both would
  // form one frame on a serial line, so the test waits after each request until the simulator has logged it.
  const auto sent = [this](bool failed, const std::string& frame) {
    return failed && modules_.simulator().wait_for("> master  " + frame);
  };
  const auto unanswered = [&](int result, const std::string& frame) {
    return sent(fails_with(ETIMEDOUT, result), frame);
  };
  master_.wait_for_replies(500);  // a short timeout, because no reply arrives
  EXPECT_TRUE(unanswered(write_coils(kBroadcast, 0, {1, 1, 1}), "00 0F 00 00 00 03 01 07"));
  EXPECT_TRUE(unanswered(modbus_write_bit(master_.at(kBroadcast), 1, 0), "00 05 00 01 00 00"));
  EXPECT_TRUE(unanswered(modbus_write_register(master_.at(kBroadcast), kTimeout, 50), "00 06 01 E8 00 32"));
  EXPECT_TRUE(unanswered(write_registers(kBroadcast, kAddress, {9, 7}), "00 10 01 E4 00 02 04 00 09 00 07"));
  if (over_modbus_tcp()) {
    master_.wait_for_replies(LibmodbusMaster::kReplies);
  }
  // With Modbus TCP, the gateway replies instead of the module.
  const int without_reply = over_modbus_tcp() ? EMBXGTAR : ETIMEDOUT;
  std::uint16_t word = 0;
  EXPECT_TRUE(sent(fails_with(without_reply, modbus_read_registers(master_.at(kOutputs), kHostOk, 1, &word)),
                   "01 03 30 38 00 01"));
  EXPECT_TRUE(
      sent(fails_with(without_reply, modbus_read_input_registers(master_.at(kInputs), kHostOk, 0, &word)),
           "02 04 30 38 00 00"));
  master_.wait_for_replies(LibmodbusMaster::kReplies);
  EXPECT_EQ(coils(kOutputs, 0, 3), (Bits{1, 0, 1}));
  for (const int address : {kOutputs, kInputs}) {
    EXPECT_EQ(registers(address, kTimeout, 1), Words{50});
    EXPECT_EQ(registers(address, kAddress, 1)[0], address) << "a broadcast must not change the address";
  }
}

TEST_P(Libmodbus, ReportsTheExceptionsOfRejectedRequests) {
  std::uint8_t bit = 0;
  // libmodbus has a name for each exception. The transcripts get every exception of every function.
  EXPECT_TRUE(fails_with(EMBXILFUN, modbus_read_input_bits(master_.at(kOutputs), 0, 1, &bit)));
  EXPECT_TRUE(fails_with(EMBXILFUN, modbus_mask_write_register(master_.at(kOutputs), kTimeout, 0xFF, 0)));
  EXPECT_TRUE(fails_with(EMBXILADD, modbus_read_bits(master_.at(kInputs), 0, 1, &bit)));
  EXPECT_TRUE(fails_with(EMBXILADD, modbus_write_bit(master_.at(kOutputs), 13, 1)));
  EXPECT_TRUE(fails_with(EMBXILVAL, modbus_read_bits(master_.at(kOutputs), 0, 0, &bit)));
  EXPECT_TRUE(fails_with(EMBXILVAL, modbus_write_register(master_.at(kOutputs), kTimeout, 256)));
  EXPECT_EQ(registers(kOutputs, kTimeout, 1), Words{0xFF});
}

TEST_P(Libmodbus, ATimeoutOfTheHostWatchdogBlocksTheOutputs) {
  EXPECT_EQ(modbus_write_bit(master_.at(kOutputs), 0, 1), 1);
  EXPECT_EQ(modbus_write_register(master_.at(kOutputs), kTimeout, 1), 1);
  EXPECT_EQ(modbus_write_bit(master_.at(kOutputs), kWatchdogEnable, 1), 1);
  while (coils(kOutputs, kTimeoutStatus, 1) == Bits{0} && !HasFailure()) {
  }
  EXPECT_EQ(coils(kOutputs, kWatchdogEnable, 1), Bits{0});
  EXPECT_EQ(coils(kOutputs, 0, 13), Bits(13, 0));
  const std::vector<std::function<int()>> output_commands{
      [&] { return modbus_write_bit(master_.at(kOutputs), 0, 1); },
      [&] { return modbus_write_bit(master_.at(kOutputs), kSafe, 1); },
      [&] { return write_coils(kOutputs, 0, Bits(13, 1)); },
      [&] { return write_coils(kOutputs, kPowerOn, Bits(13, 1)); },
  };
  for (const auto& command : output_commands) {
    EXPECT_TRUE(fails_with(EMBXSFAIL, command()));
  }
  EXPECT_EQ(modbus_write_bit(master_.at(kOutputs), kTimeoutStatus, 1), 1);
  EXPECT_EQ(modbus_write_bit(master_.at(kOutputs), 0, 1), 1);
  EXPECT_EQ(coils(kOutputs, 0, 1), Bits{1});
}

using LibmodbusOverModbusTcp = Libmodbus;

TEST_P(LibmodbusOverModbusTcp, GetsTheExceptionsOfTheGateway) {
  std::uint8_t bit = 0;
  constexpr int kAbsent = 3;
  EXPECT_TRUE(fails_with(EMBXGTAR, modbus_read_bits(master_.at(kAbsent), 0, 1, &bit)));
  // With Modbus TCP, MODBUS_TCP_SLAVE (255) is the default address of libmodbus. libmodbus itself rejects 248
  // to 254.
  EXPECT_TRUE(fails_with(EMBXGPATH, modbus_write_bit(master_.at(MODBUS_TCP_SLAVE), 0, 1)));
  EXPECT_EQ(coils(kOutputs, 0, 1), Bits{0});
}

INSTANTIATE_TEST_SUITE_P(Ways, LibmodbusOverModbusTcp, testing::Values(Way{Way::ModbusTcp, 115200}));

INSTANTIATE_TEST_SUITE_P(Ways, Libmodbus,
                         testing::Values(Way{Way::Pty, 9600}, Way{Way::Pty, 115200}, Way{Way::Tcp, 115200},
                                         Way{Way::ModbusTcp, 115200}));

}  // namespace
}  // namespace ex9000::system
