// Must not compile: the log does not begin at the start of a sector.
#include "hal/flash/record_log.hpp"

namespace ex9000::hal {

struct Flash {
  static void start_erase(std::uint32_t address);
  static void start_program(std::uint32_t address, Bytes source);
  [[nodiscard]] static bool busy();
  static void suspend();
  static void resume();
  static void read(std::uint32_t address, MutableBytes destination);
};
template class flash::RecordLog<Flash, 0x1100>;

}  // namespace ex9000::hal
