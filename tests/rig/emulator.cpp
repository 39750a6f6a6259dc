#include "tests/rig/emulator.hpp"

namespace ex9000::rig {

namespace {

/// -icount: between two instructions no time passes for the image, however long the host keeps it waiting; 8
/// ns each is about what a 50 MHz Cortex-M3 takes with its flash, times ten, for a host that has other things
/// to do.
std::vector<std::string> command_of(const std::string& image, const std::string& memory) {
  return {"qemu-system-arm",
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
          "-icount",
          "shift=3",
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

}  // namespace ex9000::rig
