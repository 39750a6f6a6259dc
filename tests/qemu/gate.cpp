// A plugin for the emulator, which AlarmClock uses. At one specified instruction, which loads a byte, the
// processor waits until the other end of a socket lets it continue. Only the processor waits, and no emulated
// time passes. A debugger would halt the whole machine, which takes ten times as long.
//
//     -plugin gate.so,address=INSTRUCTION,socket=PATH
//
// When the processor executes this instruction, the plugin sends the address from which the instruction loads
// the byte, and the number of instructions that the processor has executed in flash, and then waits for a
// byte from the socket. The address is a report: the interrupt code of AlarmClock calculates it from the UART
// flags and the levels of two pins. That code is in RAM, so its instructions do not count. This file declares
// the functions of the emulator that the plugin calls, because Debian has no package with their header,
// include/qemu/qemu-plugin.h of QEMU 7.2.
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>

extern "C" {

struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct qemu_info_t;
using Id = std::uint64_t;
using Loaded = void (*)(unsigned processor, std::uint32_t what, std::uint64_t address, void* data);

void qemu_plugin_register_vcpu_tb_trans_cb(Id id, void (*translated)(Id id, qemu_plugin_tb* block));
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb* block);
qemu_plugin_insn* qemu_plugin_tb_get_insn(const qemu_plugin_tb* block, std::size_t index);
std::uint64_t qemu_plugin_insn_vaddr(const qemu_plugin_insn* instruction);
void qemu_plugin_register_vcpu_insn_exec_inline(qemu_plugin_insn* instruction, int operation, void* operand,
                                                std::uint64_t value);
void qemu_plugin_register_vcpu_mem_cb(qemu_plugin_insn* instruction, Loaded loaded, int registers,
                                      int accesses, void* data);

__attribute__((visibility("default"))) extern const int qemu_plugin_version;
__attribute__((visibility("default"))) int qemu_plugin_install(Id id, const qemu_info_t* info, int argc,
                                                               char** argv);

const int qemu_plugin_version = 1;

}  // extern "C"

namespace {

constexpr int kNoRegisters = 0;
constexpr int kLoads = 3;  // loads and stores: QEMU 7.2 calls no plugin that registers for loads alone

constexpr int kAdd = 0;  // QEMU_PLUGIN_INLINE_ADD_U64
constexpr std::uint64_t kRam = 0x2000'0000;

int the_socket = -1;
std::uint64_t the_count = 0;
std::uint64_t the_instruction = 0;

void wait(unsigned /*processor*/, std::uint32_t /*what*/, std::uint64_t address, void* /*data*/) {
  const std::uint64_t said[] = {address, the_count};
  char go_on = 0;
  if (write(the_socket, said, sizeof said) != sizeof said || read(the_socket, &go_on, 1) != 1) {
    _exit(1);  // the other end has closed the socket
  }
}

void translated(Id /*id*/, qemu_plugin_tb* block) {
  for (std::size_t i = 0; i < qemu_plugin_tb_n_insns(block); ++i) {
    qemu_plugin_insn* const instruction = qemu_plugin_tb_get_insn(block, i);
    if (qemu_plugin_insn_vaddr(instruction) == the_instruction) {
      qemu_plugin_register_vcpu_mem_cb(instruction, wait, kNoRegisters, kLoads, nullptr);
    } else if (qemu_plugin_insn_vaddr(instruction) < kRam) {
      qemu_plugin_register_vcpu_insn_exec_inline(instruction, kAdd, &the_count, 1);
    }
  }
}

bool connect_to(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(static_cast<char*>(address.sun_path), sizeof address.sun_path - 1);
  the_socket = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  return connect(the_socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

int qemu_plugin_install(Id id, const qemu_info_t* /*info*/, int argc, char** argv) {
  bool connected = false;
  for (int i = 0; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t value = argument.find('=') + 1;
    if (argument.rfind("address=", 0) == 0) {
      the_instruction = std::stoull(argument.substr(value));
    } else if (argument.rfind("socket=", 0) == 0) {
      connected = connect_to(argument.substr(value));
    }
  }
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  return connected ? 0 : 1;
}
