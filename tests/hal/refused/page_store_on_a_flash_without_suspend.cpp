// Must not compile: this flash cannot suspend an erase, so a save would have to wait for the end of an erase.
#include "hal/flash/page_store.hpp"

namespace ex9000::hal {

struct FlashWithoutSuspend {
  static void start_erase(std::uint32_t address);
  static void start_program(std::uint32_t address, Bytes source);
  [[nodiscard]] static bool busy();
  static void read(std::uint32_t address, MutableBytes destination);
};
template class flash::PageStore<FlashWithoutSuspend, 0>;

}  // namespace ex9000::hal
