// Measures how much faster than real time a virtual line runs.
#include <benchmark/benchmark.h>

#include <array>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::bench {
namespace {

using sim::Line;
using sim::ModuleSpec;
using sim::VirtualTime;
using std::chrono::milliseconds;

constexpr unsigned kModules = 32;

std::vector<ModuleSpec> a_line_of_modules() {
  const std::array<const char*, 5> models{"9042d-m", "9043d-m", "9052d-m", "9068d-m", "9068ad-m"};
  std::vector<ModuleSpec> specs;
  for (unsigned i = 0; i < kModules; ++i) {
    specs.push_back(sim::parse_module_spec(std::string(models[i % models.size()]) + "@" +
                                           sim::hex_byte_text(i + 1) + ",baud=115200"));
  }
  return specs;
}

std::vector<std::uint8_t> frame(const std::vector<std::uint8_t>& bytes) { return with_crc(bytes); }

double seconds(VirtualTime time) { return std::chrono::duration<double>(time).count(); }

/// Measures a line on which the master sends no request except a host OK every 20 s. The host watchdog of one
/// module has expired, so the LED of this module flashes. The host watchdogs of all other modules are
/// enabled.
void idle_line(benchmark::State& state) {
  Line line(a_line_of_modules(), sim::kPaced, [](std::uint8_t, ByteStatus) {});
  const auto tell = [&line](const std::vector<std::uint8_t>& bytes, VirtualTime then) {
    const auto sent = frame(bytes);
    line.master().send(sent.data(), sent.size());
    line.wires().run_for(then);
  };
  line.come_up();
  line.master().set_baud(115200);
  tell({1, 0x06, 0x01, 0xE8, 0x00, 0x01}, milliseconds(100));
  tell({1, 0x05, 0x01, 0x04, 0xFF, 0x00}, milliseconds(300));
  for (std::uint8_t address = 2; address <= kModules; ++address) {
    tell({address, 0x05, 0x01, 0x04, 0xFF, 0x00}, milliseconds(100));
  }
  VirtualTime ran{0};
  for ([[maybe_unused]] auto _ : state) {
    tell({0, 0x03, 0x30, 0x38, 0x00, 0x00}, std::chrono::seconds(20));
    ran += std::chrono::seconds(20);
  }
  if (line.module(0).module().led_pattern() != StatusLed::Pattern::HostTimeout ||
      line.module(1).module().state().settings.timeout_status) {
    state.SkipWithError(
        "expected the host watchdog of module 1 to expire, and the host watchdog of module 2 not to expire");
  }
  state.counters["figure"] = benchmark::Counter(seconds(ran), benchmark::Counter::kIsRate);
  state.counters["at_least"] = 1000;
}
BENCHMARK(idle_line)->Name("32 modules idle, host watchdogs enabled: x real time");

/// Measures a line whose master polls the modules in turn. The master sends each request shortly after the
/// silence that follows the previous reply.
void loaded_line(benchmark::State& state) {
  bool heard = false;
  Line line(a_line_of_modules(), sim::kPaced, [&heard](std::uint8_t, ByteStatus) { heard = true; });
  line.come_up();
  line.master().set_baud(115200);
  std::vector<std::vector<std::uint8_t>> requests;
  for (std::uint8_t address = 1; address <= kModules; ++address) {
    requests.push_back(frame({address, 0x03, 0x01, 0xE2, 0x00, 0x04}));
  }
  const VirtualTime began = line.clock().virtual_now();
  std::size_t next = 0;
  for ([[maybe_unused]] auto _ : state) {
    heard = false;
    line.master().send(requests[next].data(), requests[next].size());
    next = (next + 1) % requests.size();
    // A request of 8 characters, a reply of 13 characters, two silences of 1.75 ms, and a margin for
    // rounding.
    line.wires().run_for(std::chrono::microseconds(21 * 10 * 1'000'000 / 115200 + 2 * 1752 + 10));
    if (!heard) {
      state.SkipWithError("no reply");
    }
  }
  state.counters["figure"] =
      benchmark::Counter(seconds(line.clock().virtual_now() - began), benchmark::Counter::kIsRate);
  state.counters["at_least"] = 300;
}
BENCHMARK(loaded_line)->Name("32 modules polled at 115200 baud: x real time");

}  // namespace
}  // namespace ex9000::bench
