// The reference board in QEMU, in a time of its own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/qemu/gdb_client.hpp"
#include "tests/qemu/qmp_client.hpp"
#include "tests/qemu/qtest_client.hpp"
#include "tests/qemu/unix_socket.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::rig {

/// One microcontroller from power-on to power-off, with an EEPROM behind it. Made halted before its first
/// instruction, so that its pins can be given their levels. Destroyed as by a power cut.
///
/// Where the image resets itself, or the watchdog does, the machine halts instead, for the same reason.
///
/// The thread that makes one stays on one processor of the host from then on: see processor.hpp.
///
/// An instruction takes 16 ns. While the processor sleeps, time jumps to what it waits for. AlarmClock runs
/// the machine.
class Emulator {
 public:
  /// The address of the instruction at which it waits to be let go on.
  static constexpr std::uint32_t kGate = 0x2000'9048;

  /// Runs the ELF file `image`; `memory` is the file that holds the EEPROM's 8192 bytes. Throws
  /// std::runtime_error where it does not come up.
  Emulator(const std::string& image, const std::string& memory);

  /// As the reset pin does, while halted; it stays halted. Inputs read 0 after it.
  void reset();

  QmpClient& qmp() { return *qmp_; }
  QtestClient& bus() { return *bus_; }
  GdbClient& gdb() { return *gdb_; }
  /// Where its processor waits at `kGate`: see gate.cpp.
  UnixSocket& gate() { return *gate_; }
  /// UART0, without regard to rates; what it sends has to be taken now and then, for a full socket (278
  /// bytes) halts the machine.
  UnixSocket& uart() { return *uart_; }
  [[nodiscard]] int pid() const { return process_->pid(); }

 private:
  system::Directory directory_;
  std::optional<system::ChildProcess> process_;
  std::optional<UnixSocket> uart_;
  std::optional<QmpClient> qmp_;
  std::optional<QtestClient> bus_;
  std::optional<GdbClient> gdb_;
  std::optional<UnixSocket> gate_;
};

}  // namespace ex9000::rig
