#include "tests/qemu/emulator.hpp"

#include <sys/syscall.h>
#include <unistd.h>

#include <stdexcept>
#include <utility>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "tests/qemu/processor.hpp"
#include "tests/qemu/uart_registers.hpp"
#include "tests/support/in_repository.hpp"

namespace ex9000::rig {

namespace {

std::vector<std::string> command_of(const std::string& image, const std::string& memory) {
  return {"setpriv",  // so that the emulator ends when the test ends
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
          "reboot=shutdown,shutdown=pause,watchdog=reset",
          "-chardev",
          "socket,id=uart,path=uart",
          "-serial",
          "chardev:uart",
          "-chardev",
          "socket,id=qmp,path=qmp,mux=on",  // without a mux, each tick would wake a separate thread
          "-mon",
          "chardev=qmp,mode=control",
          "-qtest",
          "unix:qtest",
          "-qtest-log",
          "none",
          "-drive",
          "if=none,id=memory,format=raw,cache=unsafe,file=" + memory,
          "-device",
          "at24c-eeprom,bus=i2c,address=0x50,rom-size=8192,drive=memory",
          "-icount",
          "shift=4,sleep=off",
          "-semihosting-config",  // AlarmClock's interrupt code halts the machine with a semihosting call
          "enable=on,target=gdb",
          "-plugin",
          in_repository(EX9000_GATE) + ",socket=gate,address=" + std::to_string(Emulator::kGate),
          "-chardev",
          "socket,id=gdb,path=gdb",
          "-gdb",
          "chardev:gdb"};
}

/// Returns the emulator's connection. Throws std::runtime_error if the emulator ends first.
UnixSocket accepted(UnixListener& listener, int pid) {
  const sim::FileDescriptor ended(static_cast<int>(syscall(SYS_pidfd_open, pid, 0)));
  std::optional<UnixSocket> connection = listener.accept(ended.get());
  if (!connection) {
    throw std::runtime_error("emulator: it has ended; expected it to connect");
  }
  return std::move(*connection);
}

}  // namespace

Emulator::Emulator(const std::string& image, const std::string& memory) {
  bind_to_one_processor();
  UnixListener uart(directory_ / "uart");
  UnixListener qmp(directory_ / "qmp");
  UnixListener qtest(directory_ / "qtest");
  UnixListener gdb(directory_ / "gdb");
  UnixListener gate(directory_ / "gate");
  process_.emplace(command_of(image, memory), directory_.path(), system::ChildProcess::Errors::WithOutput);
  try {
    uart_.emplace(accepted(uart, pid()));
    qmp_.emplace(accepted(qmp, pid()));
    bus_.emplace(accepted(qtest, pid()));
    gdb_.emplace(accepted(gdb, pid()));
    gate_.emplace(accepted(gate, pid()));
  } catch (const std::runtime_error&) {
    const int status = process_->wait();
    throw std::runtime_error("emulator: it has ended with status " + std::to_string(status) + ": " +
                             process_->output());
  }
}

/// With reboot=shutdown, the emulator halts the machine when a reset is requested. Therefore this function
/// temporarily sets reboot=reset. The emulated UARTs ignore a reset, so this function also restores the
/// registers of UART0 that affect the start of an image.
void Emulator::reset() {
  qmp_->execute("set-action", "return", R"({"reboot": "reset"})");
  qmp_->execute("system_reset", "RESET");
  qmp_->execute("set-action", "return", R"({"reboot": "shutdown"})");
  bus_->write(kUart0 + kUartInterruptMask, 0);
  bus_->write(kUart0 + kUartControl, kUartControlAtReset);
  bus_->write(kUart0 + kUartLineControl, kUartFifosOn);  // a change of this bit empties the FIFOs
  bus_->write(kUart0 + kUartLineControl, 0);
  bus_->read(kUart0);  // clears the flag and the interrupt of an unread byte
}

void Emulator::send_break() { qmp_->execute("chardev-send-break", "return", R"({"id": "uart"})"); }

}  // namespace ex9000::rig
