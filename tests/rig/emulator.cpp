#include "tests/rig/emulator.hpp"

namespace ex9000::rig {

namespace {

constexpr std::uint32_t kUart0 = 0x4000'C000;
constexpr std::uint32_t kLineControl = 0x2C;
constexpr std::uint32_t kFifosOn = 0x10;
constexpr std::uint32_t kControl = 0x30;
constexpr std::uint32_t kControlAtReset = 0x300;
constexpr std::uint32_t kInterruptMask = 0x38;

/// Without -icount: it costs twice the host's time, and what it promises, that no time passes for the image
/// while the host keeps it waiting, it does not keep where the image sleeps between two bytes.
std::vector<std::string> command_of(const std::string& image, const std::string& memory) {
  return {"setpriv",  // whatever ends the test ends the emulator
          "--pdeathsig",
          "KILL",
          "qemu-system-arm",
          "-machine",
          "lm3s6965evb",
          "-display",
          "none",
          "-nodefaults",
          "-nic",
          "none",
          "-kernel",
          image,
          "-S",
          "-action",
          "reboot=shutdown,shutdown=pause,watchdog=pause",
          "-chardev",
          "socket,id=uart,path=uart",
          "-serial",
          "chardev:uart",
          "-qmp",
          "unix:qmp",
          "-qtest",
          "unix:qtest",
          "-qtest-log",
          "none",
          "-drive",
          "if=none,id=memory,format=raw,file=" + memory,
          "-device",
          "at24c-eeprom,bus=i2c,address=0x50,rom-size=8192,drive=memory"};
}

}  // namespace

Emulator::Emulator(const std::string& image, const std::string& memory,
                   const std::vector<std::string>& options) {
  std::vector<std::string> command = command_of(image, memory);
  command.insert(command.end(), options.begin(), options.end());
  UnixListener uart(directory_ / "uart");
  UnixListener qmp(directory_ / "qmp");
  UnixListener qtest(directory_ / "qtest");
  process_.emplace(command, directory_.path(), system::ChildProcess::Errors::WithOutput);
  uart_.emplace(uart.accept());
  qmp_.emplace(qmp.accept());
  bus_.emplace(qtest.accept());
}

/// Told to halt where there would be a reset, the emulator does so even if it is asked for one. And its UARTs
/// have no reset: what matters of it is made up for.
void Emulator::reset() {
  qmp_->execute("set-action", "return", R"({"reboot": "reset"})");
  qmp_->execute("system_reset", "RESET");
  qmp_->execute("set-action", "return", R"({"reboot": "shutdown"})");
  bus_->write(kUart0 + kInterruptMask, 0);
  bus_->write(kUart0 + kControl, kControlAtReset);
  bus_->write(kUart0 + kLineControl, kFifosOn);  // a change of it empties them
  bus_->write(kUart0 + kLineControl, 0);
}

}  // namespace ex9000::rig
