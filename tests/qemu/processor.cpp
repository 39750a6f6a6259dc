#include "tests/qemu/processor.hpp"

#include <sched.h>

namespace ex9000::rig {

void bind_to_processor(int processor) {
  const sched_param none{};
  sched_setscheduler(0, SCHED_BATCH, &none);
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<unsigned>(processor), &only);
  sched_setaffinity(0, sizeof only, &only);
}

void bind_to_one_processor() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  if (CPU_COUNT(&allowed) != 1) {
    bind_to_processor(sched_getcpu());
  }
}

}  // namespace ex9000::rig
