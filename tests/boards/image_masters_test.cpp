// Tests the image of the EX9042D-M on an emulated board with unmodified third-party masters. CMake builds one
// test program for each emulated board. The expected values come from firmware/wire.md section 7.
#include <gtest/gtest.h>
#include <modbus/modbus.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <string>
#include <vector>

#include EX9000_EMULATED_MODULE_HEADER
#include "tests/masters/libmodbus_master.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/pty_bridge.hpp"

namespace ex9000 {
namespace {

using Bytes = system::PtyBridge::Bytes;

class ImageAndMaster : public testing::Test {
 protected:
  void TearDown() override { bridge_.end(); }

  std::string mbpoll(const std::vector<std::string>& options, const std::vector<std::string>& values = {}) {
    std::vector<std::string> command{"mbpoll", "-m", "rtu",  "-a", "1", "-b",
                                     "9600",   "-P", "none", "-0", "-1"};
    command.insert(command.end(), {"-o", std::to_string(kPatience.count())});
    command.insert(command.end(), options.begin(), options.end());
    command.push_back(bridge_.tty());
    command.insert(command.end(), values.begin(), values.end());
    const system::Finished finished = system::run(command);
    EXPECT_EQ(finished.status, 0) << finished.error;
    return finished.output;
  }

  /// The time that a busy host may need to simulate a request and its reply.
  static constexpr std::chrono::seconds kPatience{10};

  EmulatedModule module_;
  system::PtyBridge bridge_{[this](const Bytes& request) { return module_.reply_of(request); }};
};

TEST_F(ImageAndMaster, MbpollWritesCoilsAndReadsThemBack) {
  EXPECT_NE(mbpoll({"-t", "0", "-r", "2"}, {"1"}).find("Written 1 references."), std::string::npos);
  EXPECT_EQ(module_.outputs(), 0x0004);
  EXPECT_NE(mbpoll({"-t", "0", "-r", "4"}, {"1", "0", "1"}).find("Written 3 references."), std::string::npos);
  EXPECT_EQ(module_.outputs(), 0x0054);
  EXPECT_NE(
      mbpoll({"-t", "0", "-r", "0", "-c", "7"}).find("[2]: \t1\n[3]: \t0\n[4]: \t1\n[5]: \t0\n[6]: \t1"),
      std::string::npos);
}

TEST_F(ImageAndMaster, MbpollWritesARegisterAndReadsItBack) {
  EXPECT_NE(mbpoll({"-t", "4", "-r", "0x1E8"}, {"100"}).find("Written 1 references."), std::string::npos);
  EXPECT_NE(mbpoll({"-t", "4", "-r", "0x1E8"}).find("\t100\n"), std::string::npos);
}

TEST_F(ImageAndMaster, LibmodbusWritesAndReadsCoilsAThousandTimes) {
  constexpr int kPolls = 1000;
  constexpr int kCoils = 13;
  system::LibmodbusMaster master(bridge_.tty(), 9600);
  master.wait_for_replies(std::chrono::milliseconds(kPatience).count());
  modbus_t* const module = master.at(1);
  for (int i = 0; i < kPolls; ++i) {
    SCOPED_TRACE("poll " + std::to_string(i));
    const int channel = i % kCoils;
    const bool on = i / kCoils % 2 == 0;
    std::array<std::uint8_t, kCoils> coils{};
    ASSERT_EQ(modbus_write_bit(module, channel, on ? 1 : 0), 1) << modbus_strerror(errno);
    ASSERT_EQ(modbus_read_bits(module, 0, kCoils, coils.data()), kCoils) << modbus_strerror(errno);
    ASSERT_EQ(coils.at(static_cast<std::size_t>(channel)), on ? 1 : 0);
  }
}

}  // namespace
}  // namespace ex9000
