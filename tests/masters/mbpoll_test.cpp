// Tests the simulator with unmodified mbpoll, on one line with two modules. Uses every Modbus function that
// mbpoll supports. The expected values are from firmware/wire.md 7. The expected exceptions of the gateway
// are from sim/docs/integrations.md.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/hang.hpp"
#include "tests/support/two_modules.hpp"

namespace ex9000::system {
namespace {

using Arguments = std::vector<std::string>;

class Mbpoll : public testing::TestWithParam<Way> {
 protected:
  /// Runs mbpoll once with these options and values. With the option -0, the references of mbpoll count from
  /// 0, like the addresses on the line.
  Finished mbpoll(const Arguments& options, const Arguments& values = {}) {
    Arguments command{"mbpoll", "-0", "-1", "-o", "10"};  // -o: response timeout in s, for a busy machine
    const Arguments port = over_modbus_tcp()
                               ? Arguments{"-m", "tcp", "-p", std::to_string(modules_.modbus_tcp_port())}
                               : Arguments{"-m", "rtu", "-b", std::to_string(GetParam().baud), "-P", "none"};
    command.insert(command.end(), port.begin(), port.end());
    command.insert(command.end(), options.begin(), options.end());
    command.push_back(over_modbus_tcp() ? "127.0.0.1" : modules_.tty());
    command.insert(command.end(), values.begin(), values.end());
    return run(command);
  }
  static bool over_modbus_tcp() { return GetParam().port == Way::ModbusTcp; }

  void expect_line(const Arguments& options, const std::string& line, const Arguments& values = {}) {
    const Finished finished = mbpoll(options, values);
    EXPECT_EQ(finished.status, 0) << finished.error;
    EXPECT_NE(finished.output.find(line + "\n"), std::string::npos) << line << "\n" << finished.output;
  }
  void expect_refusal(const Arguments& options, const std::string& why, const Arguments& values = {}) {
    const Finished finished = mbpoll(options, values);
    EXPECT_EQ(finished.status, 1) << finished.output;
    EXPECT_NE(finished.error.find("failed: " + why + "\n"), std::string::npos) << finished.error;
  }
  /// Expects that mbpoll has sent this frame. mbpoll itself selects the function, for example a single or a
  /// multiple write.
  void expect_sent(const std::string& frame) {
    EXPECT_TRUE(modules_.simulator().wait_for("> master  " + frame)) << modules_.simulator().output();
  }

  TwoModules modules_{GetParam()};
};

TEST_P(Mbpoll, ReadsAndWritesBothModulesAlternately) {
  expect_line({"-a", "1", "-t", "0", "-r", "2"}, "Written 1 references.", {"1"});
  expect_sent("01 05 00 02 FF 00");
  expect_line({"-a", "2", "-t", "1", "-r", "0", "-c", "8"}, "[7]: \t0");
  expect_sent("02 02 00 00 00 08");
  expect_line({"-a", "1", "-t", "0", "-r", "4"}, "Written 3 references.", {"1", "0", "1"});
  expect_sent("01 0F 00 04 00 03 01 05");
  expect_line({"-a", "2", "-t", "3", "-r", "0", "-c", "8"}, "[7]: \t0");
  expect_sent("02 04 00 00 00 08");
  expect_line({"-a", "1", "-t", "0", "-r", "0", "-c", "13"},
              "[0]: \t0\n[1]: \t0\n[2]: \t1\n[3]: \t0\n[4]: \t1\n[5]: \t0\n[6]: \t1\n[7]: \t0\n[8]: \t0\n"
              "[9]: \t0\n[10]: \t0\n[11]: \t0\n[12]: \t0");
  expect_sent("01 01 00 00 00 0D");
  expect_line({"-a", "2", "-t", "4", "-r", "0x1E8"}, "Written 1 references.", {"100"});
  expect_sent("02 06 01 E8 00 64");
  expect_line({"-a", "1", "-t", "4", "-r", "0x1E4"}, "Written 2 references.", {"9", "7"});
  expect_sent("01 10 01 E4 00 02 04 00 09 00 07");
  expect_line({"-a", "2", "-t", "4", "-r", "0x1E8"}, "[488]: \t100");
  expect_sent("02 03 01 E8 00 01");
  expect_line({"-a", "1", "-t", "4:hex", "-r", "0x1E2", "-c", "4"},
              "[482]: \t0x0090\n[483]: \t0x4200\n[484]: \t0x0009\n[485]: \t0x0007");
  expect_line({"-a", "1,2", "-t", "4:hex", "-r", "0x1E3"},
              "[483]: \t0x4200\n-- Polling slave 2...\n[483]: \t0x5200");
}

TEST_P(Mbpoll, ReportsTheServerIdOnlyInRtuMode) {
  if (over_modbus_tcp()) {
    const std::string only_rtu = mbpoll({"-a", "1", "-u"}).error;
    EXPECT_NE(only_rtu.find("-u is available only in RTU mode"), std::string::npos) << only_rtu;
    return;
  }
  // mbpoll uses the first byte as the whole id and the second as the status. It prints FF in hex because FF
  // is not a printable character.
  expect_line({"-a", "1", "-u"}, "Length: 8\nId    : 0x90\nStatus: On\nData  : \\FF9042M");
  expect_line({"-a", "2", "-u"}, "Length: 8\nId    : 0x90\nStatus: On\nData  : \\FF9052M");
}

TEST_P(Mbpoll, NamesTheExceptionsItGets) {
  const std::string function = "Illegal function";
  const std::string address = "Illegal data address";
  const std::string value = "Illegal data value";
  expect_refusal({"-a", "1", "-t", "1", "-r", "0", "-c", "8"}, function);
  expect_refusal({"-a", "1", "-t", "0", "-r", "12", "-c", "2"}, address);
  expect_refusal({"-a", "1", "-t", "0", "-r", "13"}, address, {"1"});
  expect_refusal({"-a", "2", "-t", "0", "-r", "0x107"}, value, {"0"});
  expect_refusal({"-a", "1", "-t", "4", "-r", "0x1E4"}, value, {"9", "2"});
}

TEST_P(Mbpoll, HostOkHasNoReplyAndATimeoutOfTheHostWatchdogBlocksTheOutputs) {
  if (over_modbus_tcp()) {
    expect_refusal({"-a", "1", "-t", "4", "-r", "0x3038"}, "Target device failed to respond");
  } else {
    // No reply arrives, so mbpoll need not wait long. expect_sent() below waits until the simulator has read
    // this request. If the next request came earlier, both would form one frame.
    expect_refusal({"-a", "1", "-t", "4", "-r", "0x3038", "-o", "0.2"}, "Connection timed out");
  }
  expect_sent("01 03 30 38 00 01");
  expect_line({"-a", "1", "-t", "4", "-r", "0x1E8"}, "Written 1 references.", {"1"});
  expect_line({"-a", "1", "-t", "0", "-r", "0x104"}, "Written 1 references.", {"1"});
  EXPECT_TRUE(becomes_true([this] {
    return mbpoll({"-a", "1", "-t", "0", "-r", "0x10D"}).output.find("]: \t0") == std::string::npos;
  }));
  const std::string blocked = "Slave device or server failure";
  expect_refusal({"-a", "1", "-t", "0", "-r", "0"}, blocked, {"1"});
  expect_refusal({"-a", "1", "-t", "0", "-r", "0"}, blocked, {"1", "1"});
  expect_line({"-a", "1", "-t", "0", "-r", "0x10D"}, "Written 1 references.", {"1"});
  expect_line({"-a", "1", "-t", "0", "-r", "0"}, "Written 1 references.", {"1"});
}

using MbpollOverModbusTcp = Mbpoll;

TEST_P(MbpollOverModbusTcp, NamesTheExceptionsOfTheGateway) {
  expect_refusal({"-a", "3", "-t", "0", "-r", "0"}, "Target device failed to respond");
  expect_refusal({"-a", "3", "-t", "0", "-r", "0"}, "Target device failed to respond", {"1"});
  // mbpoll also sends 255 if its only address is one of 248 to 254.
  expect_refusal({"-a", "255", "-t", "0", "-r", "0"}, "Gateway path unavailable");
  expect_refusal({"-a", "255", "-t", "4", "-r", "0x1E8"}, "Gateway path unavailable", {"1"});
}

TEST_P(MbpollOverModbusTcp, ABroadcastSwitchesAnOutputOnWithoutAReply) {
  expect_refusal({"-a", "0", "-t", "0", "-r", "2", "-o", "0.2"}, "Connection timed out", {"1"});
  expect_sent("00 05 00 02 FF 00");
  expect_line({"-a", "1", "-t", "0", "-r", "2"}, "[2]: \t1");
}

INSTANTIATE_TEST_SUITE_P(Ways, MbpollOverModbusTcp, testing::Values(Way{Way::ModbusTcp, 115200}));

INSTANTIATE_TEST_SUITE_P(Ways, Mbpoll,
                         testing::Values(Way{Way::Pty, 9600}, Way{Way::Pty, 115200}, Way{Way::Tcp, 115200},
                                         Way{Way::ModbusTcp, 115200}));

}  // namespace
}  // namespace ex9000::system
