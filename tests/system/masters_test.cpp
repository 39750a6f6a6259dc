// Foreign masters, unmodified, on the program's pseudo-terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <memory>
#include <string>
#include <vector>

#include "tests/system/simulator_process.hpp"

namespace ex9000::system {
namespace {

using Arguments = std::vector<std::string>;

Arguments both_modules(int baud) {
  const std::string rate = ",baud=" + std::to_string(baud);
  return {"EX9042D-M@01" + rate, "EX9052D-M@02" + rate, "--log"};
}

class LibmodbusMaster {
 public:
  LibmodbusMaster(const std::string& tty, int baud)
      : context_(modbus_new_rtu(tty.c_str(), baud, 'N', 8, 1), modbus_free) {
    modbus_set_response_timeout(context_.get(), 1, 0);
    if (modbus_connect(context_.get()) != 0) {
      throw std::runtime_error(modbus_strerror(errno));
    }
  }
  ~LibmodbusMaster() { modbus_close(context_.get()); }
  LibmodbusMaster(const LibmodbusMaster&) = delete;
  LibmodbusMaster& operator=(const LibmodbusMaster&) = delete;

  modbus_t* at(int address) {
    modbus_set_slave(context_.get(), address);
    return context_.get();
  }

 private:
  std::unique_ptr<modbus_t, void (*)(modbus_t*)> context_;
};

class Masters : public testing::TestWithParam<int> {};

TEST_P(Masters, LibmodbusPollsBothModulesAlternately) {
  SimulatorProcess simulator(both_modules(GetParam()));
  LibmodbusMaster master(simulator.tty(), GetParam());
  std::array<std::uint8_t, 16> bits{};
  std::array<std::uint16_t, 8> words{};
  for (int i = 0; i < 50; ++i) {
    const int channel = i % 13;
    ASSERT_EQ(modbus_write_bit(master.at(1), channel, 1), 1) << modbus_strerror(errno);
    ASSERT_EQ(modbus_read_bits(master.at(1), 0, 13, bits.data()), 13) << modbus_strerror(errno);
    EXPECT_EQ(bits[static_cast<std::size_t>(channel)], 1);
    ASSERT_EQ(modbus_read_input_bits(master.at(2), 0, 8, bits.data()), 8) << modbus_strerror(errno);
    ASSERT_EQ(modbus_read_registers(master.at(2), 0x01E2, 2, words.data()), 2) << modbus_strerror(errno);
    EXPECT_EQ(words[0], 0x0090);
    EXPECT_EQ(words[1], 0x5200);
  }
}

TEST_P(Masters, LibmodbusGetsWhatItAsksForAndTheExceptionsItDeserves) {
  SimulatorProcess simulator(both_modules(GetParam()));
  LibmodbusMaster master(simulator.tty(), GetParam());
  const std::array<std::uint8_t, 13> pattern{1, 0, 1, 1, 0, 0, 1, 0, 1, 1, 1, 0, 1};
  std::array<std::uint8_t, 13> bits{};
  ASSERT_EQ(modbus_write_bits(master.at(1), 0, 13, pattern.data()), 13);
  ASSERT_EQ(modbus_read_bits(master.at(1), 0, 13, bits.data()), 13);
  EXPECT_EQ(bits, pattern);
  ASSERT_EQ(modbus_write_register(master.at(1), 0x01E8, 100), 1);
  const std::array<std::uint16_t, 2> address_and_baud{9, 6};
  ASSERT_EQ(modbus_write_registers(master.at(1), 0x01E4, 2, address_and_baud.data()), 2);
  std::array<std::uint16_t, 2> words{};
  ASSERT_EQ(modbus_read_registers(master.at(1), 0x01E4, 2, words.data()), 2);
  EXPECT_EQ(words, address_and_baud);
  std::array<std::uint8_t, 64> id{};
  ASSERT_EQ(modbus_report_slave_id(master.at(1), static_cast<int>(id.size()), id.data()), 8);
  EXPECT_EQ(std::string(id.begin() + 3, id.begin() + 8), "9042M");
  EXPECT_EQ(id[2], 0xFF);

  EXPECT_EQ(modbus_read_bits(master.at(1), 0, 14, bits.data()), -1);
  EXPECT_EQ(errno, EMBXILADD);
  EXPECT_EQ(modbus_write_register(master.at(1), 0x01E4, 248), -1);
  EXPECT_EQ(errno, EMBXILVAL);
  EXPECT_EQ(modbus_read_input_bits(master.at(1), 0, 8, bits.data()), -1);
  EXPECT_EQ(errno, EMBXILFUN);
}

TEST_P(Masters, MbpollPollsBothModulesAlternately) {
  SimulatorProcess simulator(both_modules(GetParam()));
  const std::string baud = std::to_string(GetParam());
  const auto mbpoll = [&](Arguments rest) {
    Arguments command{"mbpoll", "-m", "rtu", "-b", baud, "-P", "none"};
    command.insert(command.end(), rest.begin(), rest.end());
    return run(command);
  };
  const std::string tty = simulator.tty();
  for (int round = 0; round < 3; ++round) {
    const Finished written = mbpoll({"-a", "1", "-t", "0", "-r", std::to_string(round + 1), tty, "1"});
    EXPECT_EQ(written.status, 0) << written.error;
    EXPECT_NE(written.output.find("Written 1 references"), std::string::npos) << written.output;
    const Finished outputs = mbpoll({"-a", "1", "-t", "0", "-r", "1", "-c", "13", "-1", tty});
    EXPECT_EQ(outputs.status, 0) << outputs.error;
    EXPECT_NE(outputs.output.find("[" + std::to_string(round + 1) + "]: \t1"), std::string::npos)
        << outputs.output;
    const Finished inputs = mbpoll({"-a", "2", "-t", "1", "-r", "1", "-c", "8", "-1", tty});
    EXPECT_EQ(inputs.status, 0) << inputs.error;
    EXPECT_NE(inputs.output.find("[8]: \t0"), std::string::npos) << inputs.output;
    const Finished counters = mbpoll({"-a", "2", "-t", "3", "-r", "1", "-c", "8", "-1", tty});
    EXPECT_EQ(counters.status, 0) << counters.error;
  }
  const Finished beyond = mbpoll({"-a", "2", "-t", "1", "-r", "8", "-c", "2", "-1", tty});
  EXPECT_NE((beyond.output + beyond.error).find("Illegal data address"), std::string::npos) << beyond.error;
}

INSTANTIATE_TEST_SUITE_P(Rates, Masters, testing::Values(9600, 115200));

/// What a terminal program does: opens the line, sets a rate, writes text, reads text.
class Terminal {
 public:
  Terminal(const std::string& tty, speed_t speed) : fd_(open(tty.c_str(), O_RDWR | O_NOCTTY)) {
    termios settings{};
    tcgetattr(fd_, &settings);
    cfmakeraw(&settings);
    cfsetspeed(&settings, speed);
    tcsetattr(fd_, TCSANOW, &settings);
  }
  ~Terminal() { close(fd_); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void type(const std::string& text) {
    ASSERT_EQ(write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// Up to CR, or what has come within half a second.
  std::string read_line() {
    std::string line;
    pollfd ready{fd_, POLLIN, 0};
    while ((line.empty() || line.back() != '\r') && poll(&ready, 1, 500) == 1) {
      char character = 0;
      if (read(fd_, &character, 1) != 1) {
        break;
      }
      line += character;
    }
    return line;
  }

 private:
  int fd_;
};

TEST(Dcon, ATypedSessionIsAnswered) {
  SimulatorProcess simulator({"9068d-m@0A,protocol=ascii,name=PUMP", "--log"});
  Terminal terminal(simulator.tty(), B9600);
  terminal.type("$0AM\r");
  EXPECT_EQ(terminal.read_line(), "!0APUMP\r");
  for (const char key : std::string("@0A81\r")) {
    terminal.type(std::string(1, key));
  }
  EXPECT_EQ(terminal.read_line(), ">\r");
  terminal.type("@0A\r");
  EXPECT_EQ(terminal.read_line(), ">8100\r");
  EXPECT_TRUE(simulator.wait_for("> master  @0A81\\r  ; @AA(Data): set all outputs")) << simulator.output();
  EXPECT_TRUE(simulator.wait_for("< 0A EX9068D-M  !0APUMP\\r  ; answer")) << simulator.output();
}

TEST(Dcon, AReplyThatNobodyHasWaitedForIsNotTheNextMastersFirst) {
  SimulatorProcess simulator({"EX9042D@05,name=FIRST", "--log"});
  {
    Terminal impatient(simulator.tty(), B9600);
    impatient.type("$05M\r");
  }
  ASSERT_TRUE(simulator.wait_for("!05FIRST")) << simulator.output();
  Terminal terminal(simulator.tty(), B9600);
  terminal.type("$052\r");
  EXPECT_EQ(terminal.read_line(), "!05400600\r");
}

TEST(Dcon, TheRateThatAMasterSetsIsTheLinesAndAMismatchIsSaid) {
  SimulatorProcess simulator({"EX9042D@05,baud=19200", "--baud", "9600"});
  EXPECT_TRUE(simulator.wait_for("the line is at 9600 baud, EX9042D at 05 listens at 19200"))
      << simulator.output();
  {
    Terminal terminal(simulator.tty(), B19200);
    terminal.type("$052\r");
    EXPECT_EQ(terminal.read_line(), "!05400700\r");
  }
  Terminal terminal(simulator.tty(), B1200);
  terminal.type("$052\r");
  EXPECT_EQ(terminal.read_line(), "");
  EXPECT_TRUE(simulator.wait_for("the line is at 1200 baud, EX9042D at 05 listens at 19200"))
      << simulator.output();
}

}  // namespace
}  // namespace ex9000::system
