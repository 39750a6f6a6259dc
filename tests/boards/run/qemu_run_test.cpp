// Tests boards/lm3s6965evb/run in the cases that run_test.cpp does not test: the master never reads, a fault
// or the module watchdog resets the module, the image is for the LaunchPad, or QEMU reports an error.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "tests/boards/run/running_image.hpp"
#include "tests/qemu/gdb_client.hpp"
#include "tests/support/free_port.hpp"

namespace ex9000::system {
namespace {

TEST(QemuRun, AMasterThatNeverReadsDoesNotStopTheModule) {
  const RunningImage image("EX9042D");
  {
    Terminal terminal(image.tty(), 9600);
    for (int request = 0; request < 1000; ++request) {  // the replies fill the buffer of a terminal twice
      terminal.type("$01M\r");
      // The pause leaves time for a reply. The test also passes if some requests are lost.
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  EXPECT_TRUE(gets(image, "$012", "!01400600"));
}

// --- resets ---

/// A debugger. The processor stops while the debugger is connected.
class Debugger {
 public:
  explicit Debugger(std::uint16_t port) : client_(rig::UnixSocket(connected_to(port))) {
    ask("qXfer:features:read:target.xml:0,fff");  // QEMU then allows writes to single registers
  }

  void write_memory(std::uint32_t address, const std::string& hex) {
    EXPECT_EQ(ask("M" + hex_of(address) + "," + std::to_string(hex.size() / 2) + ":" + hex), "OK");
  }
  void send_processor_to(std::uint32_t address) {
    EXPECT_EQ(ask("Pf=" + hex_of(__builtin_bswap32(address))), "OK");
  }
  void leave() { EXPECT_EQ(ask("D"), "OK"); }

 private:
  static int connected_to(std::uint16_t port) {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    return fd;
  }
  static std::string hex_of(std::uint32_t word) {
    std::array<char, 9> digits{};
    std::snprintf(digits.data(), digits.size(), "%08x", word);
    return digits.data();
  }
  std::string ask(const std::string& command) {
    client_.send(rig::GdbClient::framed(command));
    std::string reply = client_.receive();
    while (!reply.empty() && reply[0] == 'T') {  // 'T' begins a report that the processor has stopped
      reply = client_.receive();
    }
    return reply;
  }

  rig::GdbClient client_;
};

/// If INIT* were low, the module would start in INIT mode and no longer reply at address 01.
TEST(QemuRun, InitStaysReleasedWhenTheModuleResetsItself) {
  constexpr std::uint32_t kNothingThere = 0xF0000000;
  constexpr std::uint32_t kDeafLoop = 0x20008000;
  constexpr std::uint32_t kLoop = kDeafLoop + 2;
  const std::string port = std::to_string(free_port());
  const RunningImage image("EX9042D", {"--gdb", port});
  EXPECT_EQ(image.ask("$015"), "!011");
  // The first address causes a fault. The other two make the image hang until the watchdog resets the module.
  for (const std::uint32_t address : {kNothingThere, kLoop, kDeafLoop}) {
    EXPECT_EQ(image.ask("$015"), "!010");
    EXPECT_EQ(image.ask("@010005"), ">");
    Debugger debugger(static_cast<std::uint16_t>(std::stoi(port)));
    // The two instructions are `cpsid i` and `b .`. Neither the data nor the stack of the image uses the
    // bytes at kDeafLoop.
    debugger.write_memory(kDeafLoop, "72b6fee7");
    debugger.send_processor_to(address);
    debugger.leave();
    ASSERT_TRUE(gets(image, "$01M", "!019042D")) << address;
    EXPECT_EQ(image.ask_behind("!019042D", "$015"), "!011");
    EXPECT_EQ(image.ask("@01"), ">0000");
  }
}

// --- refusals ---

TEST(QemuRun, RefusesAnImageForTheLaunchPad) {
  const Directory directory;
  std::string image = bytes_of_file(image_of("EX9042D"));
  const std::string top_of_ram("\x00\x00\x01\x20", 4);
  const std::string top_of_the_launchpads("\x00\x80\x00\x20", 4);
  image.replace(image.find(top_of_ram), top_of_ram.size(), top_of_the_launchpads);
  write_file(directory / "other.elf", image);
  expect_refusal(directory, {"other.elf"}, {"other.elf: the image is for another board", "lm3s6965evb"});
}

TEST(QemuRun, ReportsTheErrorMessageOfQemu) {
  const Directory directory;
  const std::string port = std::to_string(free_port());
  const RunningImage other("EX9042D", {"--gdb", port});
  expect_refusal(directory, {image_of("EX9042D"), "--gdb", port},
                 {"qemu-system-arm: the emulator has ended", "in use", "start it again"}, 1);
}

}  // namespace
}  // namespace ex9000::system
