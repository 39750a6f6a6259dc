// Measures the processor time that the firmware core requires from the first byte of a request to the end of
// the reply. The result includes the functions of the core that interrupts call. It does not include the time
// that the bytes take on a serial line.
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "firmware/line/crc16.hpp"
#include "firmware/module.hpp"
#include "tests/support/clock_at.hpp"
#include "tests/support/instant_memory.hpp"

namespace ex9000::bench {
namespace {

/// A module whose clock advances only during its start and in `ask`. The module accesses its memory only
/// during its start, because no request in this file stores settings.
class BareModule {
 public:
  explicit BareModule(const Model& model, bool ascii) : module_(model) {
    if (ascii && model.speaks_modbus()) {
      Settings settings = Settings::factory(model);
      settings.protocol = Protocol::Ascii;
      memory_.store(model, settings);
    }
    module_.start(0, now_);
    while (!module_.listening()) {
      pass(1000);
    }
    module_.listen(LineTiming::at(module_.baud(), module_.format()));
  }

  /// Sends a request. Returns the size of the reply in bytes, or 0 if the module does not reply.
  std::size_t ask(const std::vector<std::uint8_t>& request) {
    for (const std::uint8_t byte : request) {
      now_ = now_ + Duration(1042);
      module_.on_byte(byte, ByteStatus::Good, ClockAt{now_});
    }
    now_ = now_ + Duration(4013);
    module_.on_silence(now_);
    module_.step(false, now_);
    const Bytes reply = module_.take_reply(now_);
    module_.on_reply_sent(now_);
    now_ = now_ + Duration(10'000);
    return reply.size;
  }

 private:
  void pass(std::uint32_t microseconds) {
    memory_.serve(module_, now_);
    now_ = now_ + Duration(microseconds);
    module_.step(false, now_);
  }

  Module module_;
  InstantMemory memory_;
  Time now_;
};

std::vector<std::uint8_t> dcon(const std::string& command) {
  std::vector<std::uint8_t> bytes(command.begin(), command.end());
  bytes.push_back('\r');
  return bytes;
}

std::vector<std::uint8_t> modbus(std::vector<std::uint8_t> frame) {
  const Crc16 crc = crc16({frame.data(), frame.size()});
  frame.push_back(crc.low_byte());
  frame.push_back(crc.high_byte());
  return frame;
}

void request_to_reply(benchmark::State& state, std::string_view designation, bool ascii,
                      const std::vector<std::uint8_t>& request) {
  BareModule module(*find_model(designation), ascii);
  for ([[maybe_unused]] auto _ : state) {
    if (module.ask(request) == 0) {
      state.SkipWithError("no reply");
      break;
    }
  }
}

BENCHMARK_CAPTURE(request_to_reply, read 13 coils, "EX9042D-M", false, modbus({1, 1, 0, 0, 0, 13}));
BENCHMARK_CAPTURE(request_to_reply, write 13 coils, "EX9042D-M", false,
                  modbus({1, 15, 0, 0, 0, 13, 2, 0x55, 0x15}));
BENCHMARK_CAPTURE(request_to_reply, read 8 counters, "EX9052D-M", false, modbus({1, 4, 0, 0, 0, 8}));
BENCHMARK_CAPTURE(request_to_reply, DCON read channels, "EX9042D-M", true, dcon("$016"));
BENCHMARK_CAPTURE(request_to_reply, DCON set outputs, "EX9042D-M", true, dcon("@011555"));

}  // namespace
}  // namespace ex9000::bench
