// The LM3S6965 board (boards/lm3s6965evb) in QEMU, in emulated time.
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

/// The emulated machine: a microcontroller with an EEPROM. The constructor starts the emulator, and leaves
/// the machine halted before its first instruction, so that the caller can set the pin levels. The destructor
/// acts like a power cut.
///
/// If the image or the watchdog requests a reset, the machine halts instead, so that the caller can set the
/// pin levels before the reset.
///
/// The thread that creates an emulator stays on one processor of the host from then on; see processor.hpp.
///
/// An instruction takes 16 ns. While the processor sleeps, time jumps to the next event. AlarmClock
/// (alarm_clock.hpp) runs the machine.
class Emulator {
 public:
  /// The address of the instruction at which the processor waits until the host lets it continue.
  static constexpr std::uint32_t kGate = 0x2000'9048;

  /// Loads the ELF file `image`. `memory` is the file with the 8192 bytes of the EEPROM. Throws
  /// std::runtime_error with the emulator's output if the emulator does not start.
  Emulator(const std::string& image, const std::string& memory);

  /// Resets the machine like the reset pin. The machine must be halted and stays halted. Inputs read 0 after
  /// the reset.
  void reset();

  QmpClient& qmp() { return *qmp_; }
  QtestClient& bus() { return *bus_; }
  GdbClient& gdb() { return *gdb_; }
  /// Returns the socket of the gate. If the processor waits at `kGate`, a byte on this socket lets it
  /// continue; see gate.cpp.
  UnixSocket& gate() { return *gate_; }
  /// Returns the socket that is the line of UART0. It carries bytes at any baud rate. The caller must read
  /// regularly: a full socket (278 bytes) halts the machine.
  UnixSocket& uart() { return *uart_; }
  /// Makes UART0 receive a break, which is the only line error that the emulated UART supports.
  void send_break();
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
