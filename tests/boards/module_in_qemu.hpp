// A module in QEMU, for image_masters_test.cpp.
#pragma once

#include <cstdint>

#include "sim/app/play/transcript.hpp"
#include "tests/qemu/master.hpp"

namespace ex9000 {

/// An EX9042D-M with address 01. The constructor returns when the module has started.
class EmulatedModule {
 public:
  EmulatedModule() {
    module_.power(true);
    module_.run_for(rig::kComesUpWithin);
  }
  play::Bytes reply_of(const play::Bytes& request) { return rig::reply_of(module_, request); }
  std::uint16_t outputs() { return module_.outputs(); }

 private:
  rig::TimedModule module_{*find_model("EX9042D-M")};
};

}  // namespace ex9000
